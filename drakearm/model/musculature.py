"""All muscles of an arm at once: the compiled functions that every simulation of the muscles shares.

`muscles` is `Arm.muscle_table` and `paths` is `Arm.path_table`; n muscles, n_q coordinates. arm_state: q and v, (2
n_q,). fibers: activations, then fiber lengths, (2 n,). Units: m, N, Nm, s, rad, W.
"""

import numpy as np

from drakearm.errors import EquilibriumError
from drakearm.model.arm import Arm
from drakearm.model.paths import evaluate_paths
from drakearm.muscle.activation import activation_rate, activation_step
from drakearm.muscle.compiled import compiled, inner
from drakearm.muscle.contraction import (
    equilibrium_fiber_length,
    fiber_step,
    fiber_velocity,
    rigid_fiber,
    rigid_tendon_force,
    tendon_force,
)
from drakearm.muscle.energy import fiber_and_tendon_power, fiber_forces, metabolic_power
from drakearm.muscle.parameters import muscle_parameters


@compiled
def muscle_geometry(q, muscles, paths):
    """Musculotendon lengths (n,) and moment arms (n, n_q)."""
    length = np.empty(len(muscles))
    moment_arm = np.empty((len(muscles), len(q)))
    evaluate_paths(q, paths, length, moment_arm)
    return length, moment_arm


@inner
def mtu_velocity(i, moment_arm, v):
    """Rate of change (m/s) of the musculotendon length of muscle i."""
    velocity = 0.0
    for j in range(len(v)):
        velocity -= moment_arm[i, j] * v[j]
    return velocity


@inner
def muscle_force(activation, fiber_length, mtu_length, mtu_speed, m):
    """Tendon force (N) of a muscle with either kind of tendon."""
    if m.rigid_tendon:
        return rigid_tendon_force(activation, mtu_length, mtu_speed, m)[0]
    return tendon_force(fiber_length, mtu_length, m)[0]


@compiled
def tendon_forces(fibers, arm_state, muscles, paths):
    """Tendon forces (n,) and the generalized force (n_q,) that they exert."""
    n, n_q = len(muscles), len(arm_state) // 2
    length, moment_arm = muscle_geometry(arm_state[:n_q], muscles, paths)
    force = np.empty(n)
    tau = np.zeros(n_q)
    for i in range(n):
        speed = mtu_velocity(i, moment_arm, arm_state[n_q:])
        force[i] = muscle_force(
            fibers[i], fibers[n + i], length[i], speed, muscle_parameters(muscles[i], muscles[i].model_code)
        )
        for j in range(n_q):
            tau[j] += moment_arm[i, j] * force[i]
    return force, tau


@compiled
def muscle_rates(fibers, excitation, arm_state, muscles, paths):
    """Time derivatives (2 n,) of activations and fiber lengths."""
    n, n_q = len(muscles), len(arm_state) // 2
    length, moment_arm = muscle_geometry(arm_state[:n_q], muscles, paths)
    rates = np.empty(2 * n)
    for i in range(n):
        m = muscle_parameters(muscles[i], muscles[i].model_code)
        rates[i] = activation_rate(fibers[i], excitation[i], m)[0]
        if m.rigid_tendon:
            rates[n + i] = rigid_fiber(length[i], mtu_velocity(i, moment_arm, arm_state[n_q:]), m)[1]
        else:
            rates[n + i] = fiber_velocity(fibers[i], fibers[n + i], length[i], m)[0]
    return rates


@compiled
def muscle_step(state, tau, excitation, arm_state, time_step, muscles, paths):
    """Advances the muscles' state in place by one time step and writes the generalized force to hold meanwhile.

    state: activation, fiber length, fiber length one step earlier, fiber velocity, each (n,) one after the other.
    tau: (n_q,). arm_state: at the start of the step. Joints are extrapolated to the end of the step at their present
    speed; the held force is the mean of the forces at both ends. Activation, fiber and held force are all of second
    order in the time step; where a tendon is rigid, the held force is of first order, for its damping lags by half a
    step.
    """
    n, n_q = len(muscles), len(tau)
    q, v = arm_state[:n_q], arm_state[n_q:]
    length, moment_arm = muscle_geometry(q, muscles, paths)
    next_length, next_moment_arm = muscle_geometry(q + time_step * v, muscles, paths)
    tau[:] = 0.0
    for i in range(n):
        m = muscle_parameters(muscles[i], muscles[i].model_code)
        fiber, previous = state[n + i], state[2 * n + i]
        speed, next_speed = 0.0, 0.0
        activation = activation_step(state[i], excitation[i], time_step, m)
        if m.rigid_tendon:
            speed, next_speed = mtu_velocity(i, moment_arm, v), mtu_velocity(i, next_moment_arm, v)
            next_fiber, velocity, _ = rigid_fiber(next_length[i], next_speed, m)
        else:
            next_fiber, velocity = fiber_step(activation, fiber, previous, next_length[i], time_step, m)
        force = muscle_force(state[i], fiber, length[i], speed, m)
        next_force = muscle_force(activation, next_fiber, next_length[i], next_speed, m)
        for j in range(n_q):
            tau[j] += 0.5 * (moment_arm[i, j] * force + next_moment_arm[i, j] * next_force)
        state[i] = activation
        state[n + i] = next_fiber
        state[2 * n + i] = fiber
        state[3 * n + i] = velocity


@compiled
def muscle_report(fibers, velocity, excitation, arm_state, muscles, paths):
    """What users ask for: active and passive force, fiber and tendon power, metabolic power, a row (n,) each.

    velocity: of the fibers, (n,), m/s. Forces act along the fiber.
    """
    n, n_q = len(muscles), len(arm_state) // 2
    length, moment_arm = muscle_geometry(arm_state[:n_q], muscles, paths)
    report = np.empty((5, n))
    for i in range(n):
        m = muscle_parameters(muscles[i], muscles[i].model_code)
        speed = mtu_velocity(i, moment_arm, arm_state[n_q:])
        fiber = fibers[n + i]
        if m.rigid_tendon:
            fiber, _, _ = rigid_fiber(length[i], speed, m)
        force = muscle_force(fibers[i], fiber, length[i], speed, m)
        active, passive = fiber_forces(fiber, force, m)
        report[0, i], report[1, i] = active, passive
        report[2, i], report[3, i] = fiber_and_tendon_power(fiber, velocity[i], speed, force, m)
        report[4, i] = metabolic_power(fibers[i], excitation[i], fiber, velocity[i], active, passive, m)
    return report


@inner
def _equilibrium(activation, q, muscles, paths):
    length, _ = muscle_geometry(q, muscles, paths)
    fiber_length = np.empty(len(muscles))
    for i in range(len(muscles)):
        m = muscle_parameters(muscles[i], muscles[i].model_code)
        fiber_length[i] = equilibrium_fiber_length(activation[i], length[i], m)
    return fiber_length


def equilibrium_fiber_lengths(arm: Arm, q: np.ndarray, activation: np.ndarray) -> np.ndarray:
    """Fiber lengths (n,) of resting muscles at joint angles q (n_q,), rad, and activations (n,).

    Fibers on compliant tendons carry there what their tendons pull. Raises EquilibriumError, naming the muscles, where
    even the shortest fiber leaves the tendon slack.
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
    states, torques = resting_states(arm, q[None, :], activation)
    return states[0], torques[0]


def resting_states(arm: Arm, q: np.ndarray, activation: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`resting_state` of many arms: states (N, 4 n) and generalized forces (N, n_q) at joint angles q (N, n_q)."""
    activations = np.full(len(arm.muscles), activation, dtype=float)
    states, torques = _resting_states(activations, q, arm.muscle_table, arm.path_table)
    for k in np.flatnonzero(np.isnan(states).any(axis=1)):
        equilibrium_fiber_lengths(arm, q[k], activations)  # raises, and names the muscles
    return states, torques


@compiled
def _resting_states(activation, q, muscles, paths):
    n, (count, n_q) = len(muscles), q.shape
    states, torques = np.zeros((count, 4 * n)), np.empty((count, n_q))
    for k in range(count):
        state, arm_state = states[k], np.zeros(2 * n_q)
        fiber_length = _equilibrium(activation, q[k], muscles, paths)
        for i in range(n):
            state[i] = activation[i]
            state[n + i] = state[2 * n + i] = fiber_length[i]
        for j in range(n_q):
            arm_state[j] = q[k, j]
        _, tau = tendon_forces(state, arm_state, muscles, paths)
        for j in range(n_q):
            torques[k, j] = tau[j]
    return states, torques
