"""All muscles of an arm at once: the compiled functions that every simulation of the muscles shares.

`muscles` is `Arm.muscle_table` and `paths` is `Arm.path_table`; arrays of muscles have the length n, arrays of
coordinates n_q. Units: m, N, Nm, s, rad.
"""

import numpy as np
from numba import njit

from drakearm.errors import EquilibriumError
from drakearm.model.arm import Arm
from drakearm.model.paths import evaluate_paths
from drakearm.muscle.activation import activation_rate, activation_step
from drakearm.muscle.contraction import (
    equilibrium_fiber_length,
    fiber_step,
    fiber_velocity,
    tendon_force,
)


@njit(cache=True, error_model="numpy")
def muscle_geometry(q, muscles, paths):
    """Musculotendon lengths (n,) and moment arms (n, n_q)."""
    length = np.empty(len(muscles))
    moment_arm = np.empty((len(muscles), len(q)))
    evaluate_paths(q, paths, length, moment_arm)
    return length, moment_arm


@njit(cache=True, error_model="numpy")
def tendon_forces(fiber_length, q, muscles, paths):
    """Tendon forces (n,) and the generalized force (n_q,) that they exert."""
    length, moment_arm = muscle_geometry(q, muscles, paths)
    force = np.empty(len(muscles))
    tau = np.zeros(len(q))
    for i in range(len(muscles)):
        force[i], _, _ = tendon_force(fiber_length[i], length[i], muscles[i])
        for j in range(len(q)):
            tau[j] += moment_arm[i, j] * force[i]
    return force, tau


@njit(cache=True, error_model="numpy")
def muscle_rates(activation, fiber_length, excitation, q, muscles, paths):
    """Time derivatives of activations (n,) and fiber lengths (n,)."""
    length, _ = muscle_geometry(q, muscles, paths)
    rate = np.empty(len(muscles))
    velocity = np.empty(len(muscles))
    for i in range(len(muscles)):
        rate[i], _, _ = activation_rate(activation[i], excitation[i], muscles[i])
        velocity[i], _, _, _ = fiber_velocity(activation[i], fiber_length[i], length[i], muscles[i])
    return rate, velocity


@njit(cache=True, error_model="numpy")
def muscle_step(state, tau, excitation, arm_state, time_step, muscles, paths):
    """Advances the muscles' state in place by one time step and writes the generalized force to hold meanwhile.

    state: activation, fiber length, fiber length one step earlier, fiber velocity, each (n,) one after the other.
    tau: (n_q,). arm_state: q and v at the start of the step (2 n_q,). Joints are extrapolated to the end of the step at
    their present speed; the held force is the mean of the forces at both ends. Activation, fiber and held force are all
    of second order in the time step.
    """
    n, n_q = len(muscles), len(tau)
    q, v = arm_state[:n_q], arm_state[n_q:]
    length, moment_arm = muscle_geometry(q, muscles, paths)
    next_length, next_moment_arm = muscle_geometry(q + time_step * v, muscles, paths)
    tau[:] = 0.0
    for i in range(n):
        m = muscles[i]
        fiber, previous = state[n + i], state[2 * n + i]
        activation = activation_step(state[i], excitation[i], time_step, m)
        next_fiber, velocity = fiber_step(activation, fiber, previous, next_length[i], time_step, m)
        force, _, _ = tendon_force(fiber, length[i], m)
        next_force, _, _ = tendon_force(next_fiber, next_length[i], m)
        for j in range(n_q):
            tau[j] += 0.5 * (moment_arm[i, j] * force + next_moment_arm[i, j] * next_force)
        state[i] = activation
        state[n + i] = next_fiber
        state[2 * n + i] = fiber
        state[3 * n + i] = velocity


@njit(cache=True, error_model="numpy")
def _equilibrium(activation, q, muscles, paths):
    length, _ = muscle_geometry(q, muscles, paths)
    fiber_length = np.empty(len(muscles))
    for i in range(len(muscles)):
        fiber_length[i] = equilibrium_fiber_length(activation[i], length[i], muscles[i])
    return fiber_length


def equilibrium_fiber_lengths(arm: Arm, q: np.ndarray, activation: np.ndarray) -> np.ndarray:
    """Fiber lengths (n,) at which resting fibers carry what their tendons pull, at joint angles q and given
    activations.

    Raises EquilibriumError, naming the muscles, where even the shortest fiber leaves the tendon slack.
    """
    fiber_length = _equilibrium(activation, q, arm.muscle_table, arm.path_table)
    slack = [name for name, unknown in zip(arm.muscle_names, np.isnan(fiber_length), strict=True) if unknown]
    if slack:
        raise EquilibriumError(
            f"At joint angles {np.round(q, 4).tolist()} rad {', '.join(slack)} of {arm.name} cannot be in equilibrium: "
            "the path is so short that even the shortest fiber leaves the tendon slack."
        )
    return fiber_length


def resting_state(arm: Arm, q: np.ndarray, activation: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The state (4 n,) of `muscle_step` for muscles at rest, and the generalized force (n_q,) that they exert.

    activation: one for all muscles or (n,). Raises EquilibriumError where a muscle has no equilibrium at joint angles
    q.
    """
    activations = np.full(len(arm.muscles), activation, dtype=float)
    fiber_length = equilibrium_fiber_lengths(arm, q, activations)
    _, tau = tendon_forces(fiber_length, q, arm.muscle_table, arm.path_table)
    return np.concatenate([activations, fiber_length, fiber_length, np.zeros_like(fiber_length)]), tau
