"""All muscles of an arm at once: the compiled functions that every simulation of the muscles shares.

`muscles` is `Arm.muscle_table` and `paths` is `Arm.path_table`; n muscles, n_q coordinates. arm_state: q and v, (2
n_q,). fibers: activations, then fiber lengths, (2 n,). Units: m, N, Nm, s, rad, W.
"""

from typing import NamedTuple

import numpy as np

from drakearm.errors import EquilibriumError
from drakearm.model.arm import Arm
from drakearm.model.paths import PathPieces, count_terms, evaluate_path_lanes, evaluate_paths, make_path_pieces
from drakearm.muscle.activation import activation_rate, activation_step
from drakearm.muscle.compiled import compiled, inlined, inner
from drakearm.muscle.contraction import (
    bdf2_base,
    equilibrium_fiber_length,
    fiber_step,
    fiber_steps,
    fiber_velocity,
    rigid_fiber,
    rigid_tendon_force,
    shortest_fiber,
    tendon_force,
)
from drakearm.muscle.energy import fiber_and_tendon_power, fiber_forces, metabolic_power
from drakearm.muscle.parameters import DEGROOTE2016, THELEN2003, muscle_parameters


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


class MuscleLanes(NamedTuple):
    """Working memory of `step_muscle_lanes`. Rows of now, then of the end of the step, stand beside each other."""

    pieces: PathPieces
    q: np.ndarray  # (n_q, 2 lanes)
    length: np.ndarray  # (n, 2 lanes), of the musculotendon paths
    slope: np.ndarray  # (terms, 2 lanes), of the path functions
    speed: np.ndarray  # (n, 2 lanes), of the musculotendon paths, where tendons are rigid
    force: np.ndarray  # (n, 2 lanes), of the tendons
    later: np.ndarray  # (lanes,), fiber lengths


@inner
def make_muscle_lanes(muscles, paths, n_q, lanes):
    """Working memory for `lanes` arms with the same muscles."""
    n, terms = len(muscles), count_terms(paths)
    return MuscleLanes(
        make_path_pieces(paths, 2 * lanes),
        np.empty((n_q, 2 * lanes)),
        np.empty((n, 2 * lanes)),
        np.empty((terms, 2 * lanes)),
        np.zeros((n, 2 * lanes)),
        np.empty((n, 2 * lanes)),
        np.empty(lanes),
    )


@inlined
def _step_compliant(state, excitation, i, n, time_step, length, force, later, m):
    """Advances muscle i, on a compliant tendon, in every lane."""
    lanes = len(later)
    for k in range(lanes):
        force[i, k] = tendon_force(state[n + i, k], length[i, k], m)[0]
    for k in range(lanes):
        state[i, k] = activation_step(state[i, k], excitation[i, k], time_step, m)
    for k in range(lanes):
        later[k] = max(state[2 * n + i, k] + 2.0 * time_step * state[3 * n + i, k], shortest_fiber(m))
    fiber_steps(later, state, i, n, length, lanes, time_step, m)
    for k in range(lanes):
        force[i, lanes + k] = tendon_force(later[k], length[i, lanes + k], m)[0]
    for k in range(lanes):
        base = bdf2_base(state[n + i, k], state[2 * n + i, k])
        state[3 * n + i, k] = 1.5 / time_step * (later[k] - base)
        state[2 * n + i, k] = state[n + i, k]
        state[n + i, k] = later[k]


@inlined
def _step_rigid(state, excitation, i, n, time_step, length, speed, force, m):
    """Advances muscle i, on a rigid tendon, in every lane."""
    lanes = state.shape[1]
    for k in range(lanes):
        force[i, k] = rigid_tendon_force(state[i, k], length[i, k], speed[i, k], m)[0]
        state[i, k] = activation_step(state[i, k], excitation[i, k], time_step, m)
        next_length, next_speed = length[i, lanes + k], speed[i, lanes + k]
        force[i, lanes + k] = rigid_tendon_force(state[i, k], next_length, next_speed, m)[0]
        state[2 * n + i, k] = state[n + i, k]
        state[n + i, k], state[3 * n + i, k], _ = rigid_fiber(next_length, next_speed, m)


@inner
def step_muscle_lanes(state, tau, excitation, arm_state, time_step, muscles, paths, work):
    """`muscle_step` for arms side by side: every array has a second index, the lane, and `work` is for so many."""
    pieces, q, length, slope, speed, force, later = work
    n, (n_q, lanes) = len(muscles), tau.shape
    for j in range(n_q):
        for k in range(lanes):
            q[j, k] = arm_state[j, k]
            q[j, lanes + k] = arm_state[j, k] + time_step * arm_state[n_q + j, k]
    evaluate_path_lanes(q, paths, pieces, length, slope)
    _path_speeds(arm_state, paths, slope, speed)
    for i in range(n):
        # A branch for each model, so that each is compiled without the curves of the other.
        if muscles[i].rigid_tendon:
            m = muscle_parameters(muscles[i], muscles[i].model_code)
            _step_rigid(state, excitation, i, n, time_step, length, speed, force, m)
        elif muscles[i].model_code == THELEN2003:
            m = muscle_parameters(muscles[i], THELEN2003)
            _step_compliant(state, excitation, i, n, time_step, length, force, later, m)
        else:
            m = muscle_parameters(muscles[i], DEGROOTE2016)
            _step_compliant(state, excitation, i, n, time_step, length, force, later, m)
    tau[:] = 0.0
    header = term = 0
    while header < len(paths):
        i, j = int(paths[header, 0]), int(paths[header, 1])
        for k in range(lanes):
            tau[j, k] -= 0.5 * (slope[term, k] * force[i, k] + slope[term, lanes + k] * force[i, lanes + k])
        header += 1 + int(paths[header, 2])
        term += 1


@inner
def _path_speeds(arm_state, paths, slope, speed):
    """Writes the rates of change (n, 2 lanes) of the musculotendon lengths."""
    speed[:] = 0.0
    n_q, lanes = arm_state.shape[0] // 2, arm_state.shape[1]
    header = term = 0
    while header < len(paths):
        i, j = int(paths[header, 0]), int(paths[header, 1])
        for k in range(lanes):
            speed[i, k] += slope[term, k] * arm_state[n_q + j, k]
            speed[i, lanes + k] += slope[term, lanes + k] * arm_state[n_q + j, k]
        header += 1 + int(paths[header, 2])
        term += 1


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
