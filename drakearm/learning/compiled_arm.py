"""The muscle arm's Diagram as one compiled function for many arms: what `ArmVectorEnv` steps.

Skeleton, muscles and stops are those of the Diagram: equations of motion read off the plant, and the same compiled
functions that the systems call. The integrator is Drake's explicit trapezoidal rule (RungeKutta2Integrator), as in
`MakeSimulator`.
"""

import numpy as np

from drakearm.model.dynamics import forward_dynamics
from drakearm.model.joint_stops import held_stop_torque
from drakearm.model.musculature import muscle_step
from drakearm.model.tracking import tracking_reward
from drakearm.muscle.compiled import compiled


@compiled
def step_arms(arm_state, muscle_state, torque, excitation, steps, time_step, muscles, paths, dynamics, stops):
    """Advances N arms in place by a number of time steps with their excitations held.

    arm_state: (N, 2 n_q), q and v. muscle_state: (N, 4 n), see `muscle_step`. torque: (N, n_q), written: what muscles
    and stops exert in the last time step. excitation: (N, n). stops: lower and upper limits, stiffness and damping.
    """
    n_q = torque.shape[1]
    lower, upper, stiffness, damping = stops
    stop = np.empty(n_q)
    for k in range(len(arm_state)):
        x, tau = arm_state[k], torque[k]
        for _ in range(steps):
            q, v = x[:n_q], x[n_q:]
            held_stop_torque(stop, x, time_step, lower, upper, stiffness, damping)
            muscle_step(muscle_state[k], tau, excitation[k], x, time_step, muscles, paths)
            tau += stop
            a = forward_dynamics(q, v, tau, dynamics)
            later_q, later_v = q + time_step * v, v + time_step * a
            later_a = forward_dynamics(later_q, later_v, tau, dynamics)
            q += 0.5 * time_step * (v + later_v)
            v += 0.5 * time_step * (a + later_a)


@compiled
def rewards(arm_state, torque, reference_q, reference_v, weights, dynamics):
    """Rewards (N,) of N arms where they are, see `tracking_reward`; torque, reference_q, reference_v: (N, n_q)."""
    n_q = torque.shape[1]
    w_q, w_v, w_a = weights
    reward = np.empty(len(arm_state))
    for k in range(len(arm_state)):
        q, v = arm_state[k, :n_q], arm_state[k, n_q:]
        a = forward_dynamics(q, v, torque[k], dynamics)
        reward[k] = tracking_reward(q, v, a, reference_q[k], reference_v[k], w_q, w_v, w_a)
    return reward
