"""The muscle arm's Diagram as one compiled function for many arms: what `ArmVectorEnv` steps.

Skeleton, muscles and stops are those of the Diagram: equations of motion read off the plant, and the same compiled
functions that the systems call. The integrator is Drake's explicit trapezoidal rule (RungeKutta2Integrator), as in
`MakeSimulator`. Arms are taken LANES at a time, side by side: in every working array the arm is the last index, so that
one vector instruction serves several arms.
"""

import numpy as np

from drakearm.model.dynamics import forward_dynamics_lanes, make_dynamics_lanes
from drakearm.model.joint_stops import one_stop_torque
from drakearm.model.muscle_lanes import make_muscle_lanes, step_muscle_lanes
from drakearm.model.tracking import tracking_reward
from drakearm.muscle.compiled import compiled, inner

LANES = 64


@compiled
def step_arms(arm_state, muscle_state, torque, excitation, steps, time_step, muscles, paths, dynamics, stops):
    """Advances N arms in place by a number of time steps with their excitations held; returns their accelerations.

    arm_state: (N, 2 n_q), q and v. muscle_state: (N, 4 n), see `muscle_step`. torque: (N, n_q), written: what muscles
    and stops exert in the last time step. excitation: (N, n). dynamics: of N skeletons, see `stack_dynamics`. stops:
    lower and upper limits, stiffness and damping. The accelerations (N, n_q) are those at the end, with this torque.
    """
    count, n_q = torque.shape
    lower, upper, stiffness, damping = stops
    acceleration = np.empty((count, n_q))
    mass_coefficient = dynamics.mass_coefficient.reshape(count, len(dynamics.mass_entry))
    gravity_coefficient = dynamics.gravity_coefficient.reshape(count, len(dynamics.gravity_entry))
    lanes = -1
    for begin in range(0, count, LANES):
        if lanes != min(LANES, count - begin):
            lanes = min(LANES, count - begin)
            x, state, u = (
                np.empty((2 * n_q, lanes)),
                np.empty((4 * len(muscles), lanes)),
                np.empty((len(muscles), lanes)),
            )
            tau, a, later_x, later_a = (
                np.empty((n_q, lanes)),
                np.empty((n_q, lanes)),
                np.empty((2 * n_q, lanes)),
                np.empty((n_q, lanes)),
            )
            skeleton = make_dynamics_lanes(
                np.empty((mass_coefficient.shape[1], lanes)), np.empty((gravity_coefficient.shape[1], lanes)), n_q
            )
            work = make_muscle_lanes(muscles, paths, n_q, lanes)
        _gather(mass_coefficient, begin, skeleton.mass_coefficient)
        _gather(gravity_coefficient, begin, skeleton.gravity_coefficient)
        _gather(arm_state, begin, x)
        _gather(muscle_state, begin, state)
        _gather(excitation, begin, u)
        for half in range(2 * steps + 1):  # every step needs two accelerations; the last one is returned
            starts = half % 2 == 0
            if starts and half < 2 * steps:
                step_muscle_lanes(state, tau, u, x, time_step, muscles, paths, work)
                for j in range(n_q):
                    for k in range(lanes):
                        q = x[j, k] + 0.5 * time_step * x[n_q + j, k]
                        tau[j, k] += one_stop_torque(q, x[n_q + j, k], lower[j], upper[j], stiffness, damping)
            at, acceleration_at = (x, a) if starts else (later_x, later_a)
            for j in range(n_q):
                for k in range(lanes):
                    acceleration_at[j, k] = tau[j, k]
            forward_dynamics_lanes(at, acceleration_at, dynamics, skeleton)
            if half == 2 * steps:
                break
            for j in range(n_q):
                for k in range(lanes):
                    v = x[n_q + j, k]
                    if starts:
                        later_x[j, k] = x[j, k] + time_step * v
                        later_x[n_q + j, k] = v + time_step * a[j, k]
                    else:
                        x[j, k] += 0.5 * time_step * (v + later_x[n_q + j, k])
                        x[n_q + j, k] = v + 0.5 * time_step * (a[j, k] + later_a[j, k])
        _scatter(x, begin, arm_state)
        _scatter(state, begin, muscle_state)
        _scatter(tau, begin, torque)
        _scatter(a, begin, acceleration)
    return acceleration


@inner
def _gather(arms, begin, rows):
    """Copies the arms (N, size) from `begin` on into rows (size, lanes)."""
    for k in range(rows.shape[1]):
        for i in range(rows.shape[0]):
            rows[i, k] = arms[begin + k, i]


@inner
def _scatter(rows, begin, arms):
    """Copies rows (size, lanes) back into the arms (N, size) from `begin` on."""
    for k in range(rows.shape[1]):
        for i in range(rows.shape[0]):
            arms[begin + k, i] = rows[i, k]


@compiled
def rewards(arm_state, acceleration, reference_q, reference_v, weights):
    """Rewards (N,) of N arms where they are, see `tracking_reward`; all arrays (N, n_q), of weights three."""
    n_q = acceleration.shape[1]
    w_q, w_v, w_a = weights
    reward = np.empty(len(arm_state))
    for k in range(len(arm_state)):
        q, v = arm_state[k, :n_q], arm_state[k, n_q:]
        reward[k] = tracking_reward(q, v, acceleration[k], reference_q[k], reference_v[k], w_q[k], w_v[k], w_a[k])
    return reward
