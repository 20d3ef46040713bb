"""The muscle arm's Diagram as one compiled function for many arms. `ArmVectorEnv` calls it.

Skeleton, muscles and joint stops are those of the Diagram: the equations of motion are read from the plant, and muscles
and stops are the same compiled functions that the systems call. The integrator is Drake's explicit trapezoidal rule
(RungeKutta2Integrator), as in `MakeSimulator`.

Up to LANES arms form a block and are stepped together. The last index of every array is the arm within its block, its
lane. So one vector instruction computes the same quantity of several arms.
"""

import math
from typing import NamedTuple

import numpy as np

from drakearm.model import Arm
from drakearm.model.dynamics import DynamicsLanes, forward_dynamics_lanes, make_dynamics_lanes
from drakearm.model.dynamics_table import DynamicsTable
from drakearm.model.joint_stops import joint_stop_torque, stop_strength
from drakearm.model.muscle_lanes import MuscleLanes, make_muscle_lanes, muscle_kinds, step_muscle_lanes
from drakearm.muscle.compiled import compiled, fma

LANES = 128


class ArmLanes(NamedTuple):
    """The states of all arms: arrays (blocks, size, lanes)."""

    arm_state: np.ndarray  # size 2 n_q: q and v
    muscle_state: np.ndarray  # size 4 n, see `muscle_step`
    acceleration: np.ndarray  # size n_q, rad/s^2: due to muscles and stops in the latest time step


class ArmTables(NamedTuple):
    """The constants of the arms that the compiled step reads."""

    muscles: np.ndarray  # `Arm.muscle_table`
    strength: np.ndarray  # (blocks, n, lanes), factors of the maximum isometric forces in each arm
    paths: np.ndarray  # `Arm.path_table`
    kinds: tuple  # the fields of `MuscleKinds`, as a plain tuple: Numba can pass only such a one on as arguments
    dynamics: DynamicsTable  # every term that at least one of the skeletons has
    mass_coefficient: np.ndarray  # (blocks, K, lanes), of the K mass terms in each arm
    gravity_coefficient: np.ndarray  # (blocks, G, lanes), of the G gravity terms in each arm
    lower: np.ndarray  # (n_q,) rad, lower ends of the joints' ranges, where the stops begin
    upper: np.ndarray  # (n_q,) rad, upper ends
    stiffness: np.ndarray  # (n_q,) Nm/rad, of the stops
    damping: np.ndarray  # (n_q,) Nm s/rad, of the stops


class Work(NamedTuple):
    """Working memory of one block."""

    muscles: MuscleLanes
    dynamics: DynamicsLanes
    tau: np.ndarray  # (n_q, lanes) Nm
    later_x: np.ndarray  # (2 n_q, lanes), q and v at the end of a time step
    later_a: np.ndarray  # (n_q, lanes)


class CompiledArms:
    """The states of N arms, and `step`, which advances them. All have the same muscles; each has its own skeleton.

    dynamics: the stacked table of the skeletons, see `stack_dynamics`. count: N.
    lower, upper: (n_q,), rad, the ends of the joints' ranges. The stops there are as strong as `stop_strength` says.
    """

    def __init__(self, arm: Arm, dynamics: DynamicsTable, count: int, lower: np.ndarray, upper: np.ndarray):
        n, n_q = len(arm.muscles), len(arm.coordinates)
        blocks = math.ceil(count / LANES)
        lanes = math.ceil(count / blocks)
        # The arm in each lane, (blocks, lanes). The lanes that are left over repeat the last arm.
        self._arm = np.minimum(np.arange(blocks * lanes), count - 1).reshape(blocks, lanes)
        self._count = count
        self._tables = ArmTables(
            arm.muscle_table,
            np.ones((blocks, n, lanes)),
            arm.path_table,
            tuple(muscle_kinds(arm.muscle_table)),
            dynamics,
            self._to_lanes(dynamics.mass_coefficient.reshape(count, -1)),
            self._to_lanes(dynamics.gravity_coefficient.reshape(count, -1)),
            lower,
            upper,
            *stop_strength(arm),
        )
        self._work = Work(
            make_muscle_lanes(n, arm.path_table, n_q, lanes),
            make_dynamics_lanes(dynamics, n_q, lanes),
            np.empty((n_q, lanes)),
            np.empty((2 * n_q, lanes)),
            np.empty((n_q, lanes)),
        )
        self._lanes = ArmLanes(*(np.zeros((blocks, size, lanes)) for size in (2 * n_q, 4 * n, n_q)))

    @property
    def arm_state(self) -> np.ndarray:
        """A copy of q and v, (N, 2 n_q)."""
        return self._from_lanes(self._lanes.arm_state)

    @property
    def muscle_state(self) -> np.ndarray:
        """A copy of the states (N, 4 n) of `muscle_step`."""
        return self._from_lanes(self._lanes.muscle_state)

    def set_body(self, which: np.ndarray, skeletons: DynamicsTable, strength: np.ndarray) -> None:
        """Gives some arms, as many as `which` (N,), bool, selects, other skeletons and muscles of other strength.

        skeletons: their stacked tables, which must have the terms of the first skeletons. strength: (arms, n), factors
        of the maximum isometric forces.
        """
        count = len(strength)
        mass, gravity = skeletons.mass_coefficient.reshape(count, -1), skeletons.gravity_coefficient.reshape(count, -1)
        for lanes, arms in (
            (self._tables.mass_coefficient, mass),
            (self._tables.gravity_coefficient, gravity),
            (self._tables.strength, strength),
        ):
            self._set(lanes, which, arms)

    def set_state(self, which: np.ndarray, arm_state: np.ndarray, muscle_state: np.ndarray) -> None:
        """Sets the states of some arms. which: (N,), bool, selects them; the states have one row for each of them."""
        self._set(self._lanes.arm_state, which, arm_state)
        self._set(self._lanes.muscle_state, which, muscle_state)

    def step(self, excitation: np.ndarray, steps: int, time_step: float) -> np.ndarray:
        """Advances all arms by a number of time steps (s each) with constant excitations (N, n).

        Returns the accelerations (N, n_q), rad/s^2, at the end: those due to muscles and stops in the last time step.
        """
        step_arms(self._lanes, self._to_lanes(excitation), steps, time_step, self._tables, self._work)
        return self._from_lanes(self._lanes.acceleration)

    def _set(self, lanes: np.ndarray, which: np.ndarray, arms: np.ndarray) -> None:
        """Copies rows of `arms`, one for each arm that `which` selects, into an array (blocks, size, lanes)."""
        row, chosen = (np.cumsum(which) - 1)[self._arm], which[self._arm]
        lanes.swapaxes(1, 2)[chosen] = arms[row[chosen]]

    def _to_lanes(self, arms: np.ndarray) -> np.ndarray:
        """Converts an array with one row per arm (N, size) to (blocks, size, lanes)."""
        return np.ascontiguousarray(arms[self._arm].swapaxes(1, 2))

    def _from_lanes(self, blocks: np.ndarray) -> np.ndarray:
        """Converts (blocks, size, lanes) to an array with one row per arm (N, size)."""
        return np.array(blocks.swapaxes(1, 2), order="C").reshape(-1, blocks.shape[1])[: self._count]


@compiled
def step_arms(state, excitation, steps, time_step, tables, work):
    """Advances arms in place by a number of time steps with constant excitations (blocks, n, lanes).

    state: an `ArmLanes`. tables: an `ArmTables`. work: a `Work`. Times in s.
    """
    (
        muscles,
        strength,
        paths,
        kinds,
        dynamics,
        mass_coefficient,
        gravity_coefficient,
        lower,
        upper,
        stiffness,
        damping,
    ) = tables
    muscle_work, dynamics_work, tau, later_x, later_a = work
    blocks, n_q, lanes = state.acceleration.shape
    for block in range(blocks):
        x, a, u = state.arm_state[block], state.acceleration[block], excitation[block]
        muscle_state, strong = state.muscle_state[block], strength[block]
        mass, gravity = mass_coefficient[block], gravity_coefficient[block]
        for half in range(2 * steps + 1):  # a step needs two accelerations; one more, at the end, stays in `state`
            starts = half % 2 == 0
            if starts and half < 2 * steps:
                step_muscle_lanes(muscle_state, tau, u, x, time_step, muscles, strong, paths, muscle_work, *kinds)
                for j in range(n_q):
                    for k in range(lanes):
                        v = x[n_q + j, k]
                        q = fma(0.5 * time_step, v, x[j, k])
                        tau[j, k] += joint_stop_torque(q, v, lower[j], upper[j], stiffness[j], damping[j])
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
                        later_x[j, k] = fma(time_step, v, x[j, k])
                        later_x[n_q + j, k] = fma(time_step, a[j, k], v)
                    else:
                        x[j, k] = fma(0.5 * time_step, v + later_x[n_q + j, k], x[j, k])
                        x[n_q + j, k] = fma(0.5 * time_step, a[j, k] + later_a[j, k], v)
