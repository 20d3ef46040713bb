"""The muscle arm's Diagram as one compiled function for many arms: what `ArmVectorEnv` steps.

Skeleton, muscles and stops are those of the Diagram: equations of motion read off the plant, and the same compiled
functions that the systems call. The integrator is Drake's explicit trapezoidal rule (RungeKutta2Integrator), as in
`MakeSimulator`. Arms are taken up to LANES at a time, side by side: in every array the arm is the last index, so that
one vector instruction serves several arms.
"""

import math
from collections.abc import Sequence

import numpy as np

from drakearm.model import Arm
from drakearm.model.dynamics import forward_dynamics_lanes, make_dynamics_lanes
from drakearm.model.dynamics_table import DynamicsTable, stack_dynamics
from drakearm.model.joint_stops import one_stop_torque
from drakearm.model.muscle_lanes import make_muscle_lanes, muscle_kinds, step_muscle_lanes
from drakearm.muscle.compiled import compiled
from drakearm.systems.joint_stops import DAMPING, STIFFNESS

LANES = 128


class CompiledArms:
    """N arms with the same muscles, each with a skeleton of its own: their states, and `step`.

    lower, upper: ends of the joints' ranges (n_q,), rad, where they have the stops that `JointStops` has by default.
    """

    def __init__(self, arm: Arm, skeletons: Sequence[DynamicsTable], lower: np.ndarray, upper: np.ndarray):
        count, n, n_q = len(skeletons), len(arm.muscles), len(arm.coordinates)
        blocks = math.ceil(count / LANES)
        lanes = math.ceil(count / blocks)
        # The arm in every lane (blocks, lanes): lanes to spare repeat the last one.
        self._arm = np.minimum(np.arange(blocks * lanes), count - 1).reshape(blocks, lanes)
        self._count = count
        dynamics = stack_dynamics(skeletons)
        coefficients = (dynamics.mass_coefficient, dynamics.gravity_coefficient)
        self._tables = (
            arm.muscle_table,
            arm.path_table,
            muscle_kinds(arm.muscle_table),
            dynamics,
            *(self._to_lanes(c.reshape(count, -1)) for c in coefficients),
        )
        self._work = (make_muscle_lanes(n, arm.path_table, n_q, lanes), make_dynamics_lanes(dynamics, n_q, lanes))
        self._stops = (lower, upper, STIFFNESS, DAMPING)
        self._arm_state = np.zeros((blocks, 2 * n_q, lanes))
        self._muscle_state = np.zeros((blocks, 4 * n, lanes))
        self._acceleration = np.zeros((blocks, n_q, lanes))

    @property
    def arm_state(self) -> np.ndarray:
        """A copy of q and v, (N, 2 n_q)."""
        return self._from_lanes(self._arm_state)

    @property
    def muscle_state(self) -> np.ndarray:
        """A copy of the states (N, 4 n) of `muscle_step`."""
        return self._from_lanes(self._muscle_state)

    def set_state(self, which: np.ndarray, arm_state: np.ndarray, muscle_state: np.ndarray) -> None:
        """Puts the arms `which` (N,), bool, into states, a row for each of them."""
        row = (np.cumsum(which) - 1)[self._arm]
        chosen = which[self._arm]
        self._arm_state.swapaxes(1, 2)[chosen] = arm_state[row[chosen]]
        self._muscle_state.swapaxes(1, 2)[chosen] = muscle_state[row[chosen]]

    def step(self, excitation: np.ndarray, steps: int, time_step: float) -> np.ndarray:
        """Advances all arms with their excitations (N, n) held; returns the accelerations (N, n_q) at the end.

        Those are of the torques that muscles and stops exert in the last time step.
        """
        step_arms(
            self._arm_state,
            self._muscle_state,
            self._acceleration,
            self._to_lanes(excitation),
            steps,
            time_step,
            *self._tables,
            self._stops,
            *self._work,
        )
        return self._from_lanes(self._acceleration)

    def _to_lanes(self, arms: np.ndarray) -> np.ndarray:
        """Rows of arms (N, size) as (blocks, size, lanes)."""
        return np.ascontiguousarray(arms[self._arm].swapaxes(1, 2))

    def _from_lanes(self, blocks: np.ndarray) -> np.ndarray:
        """And back."""
        return np.array(blocks.swapaxes(1, 2), order="C").reshape(-1, blocks.shape[1])[: self._count]


@compiled
def step_arms(
    arm_state,
    muscle_state,
    acceleration,
    excitation,
    steps,
    time_step,
    muscles,
    paths,
    kinds,
    dynamics,
    mass_coefficient,
    gravity_coefficient,
    stops,
    muscle_work,
    dynamics_work,
):
    """Advances arms in place by a number of time steps with their excitations held, and writes their accelerations.

    Arrays are (blocks, size, lanes). Sizes: arm_state 2 n_q, q and v; muscle_state 4 n, see `muscle_step`; acceleration
    n_q; excitation n; the coefficients, of the terms of `dynamics` for each arm. stops: lower and upper
    limits (n_q,), stiffness and damping.
    """
    blocks, n_q, lanes = acceleration.shape
    lower, upper, stiffness, damping = stops
    thelen, degroote, rigid = kinds
    tau, later_x, later_a = np.empty((n_q, lanes)), np.empty((2 * n_q, lanes)), np.empty((n_q, lanes))
    for block in range(blocks):
        x, state, a, u = arm_state[block], muscle_state[block], acceleration[block], excitation[block]
        mass, gravity = mass_coefficient[block], gravity_coefficient[block]
        for half in range(2 * steps + 1):  # every step needs two accelerations; the last one is returned
            starts = half % 2 == 0
            if starts and half < 2 * steps:
                step_muscle_lanes(state, tau, u, x, time_step, muscles, paths, thelen, degroote, rigid, muscle_work)
                for j in range(n_q):
                    for k in range(lanes):
                        q = x[j, k] + 0.5 * time_step * x[n_q + j, k]
                        tau[j, k] += one_stop_torque(q, x[n_q + j, k], lower[j], upper[j], stiffness, damping)
            at, acceleration_at = (x, a) if starts else (later_x, later_a)
            for j in range(n_q):
                for k in range(lanes):
                    acceleration_at[j, k] = tau[j, k]
            forward_dynamics_lanes(at, acceleration_at, dynamics, mass, gravity, dynamics_work)
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
