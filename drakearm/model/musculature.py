"""All muscles of one arm: forces, rates, steps in time and states of rest, as compiled functions.

`muscles` is `Arm.muscle_table` and `paths` is `Arm.path_table`; n muscles, n_q coordinates. arm_state: q and v, (2
n_q,). fibers: activations, then fiber lengths, (2 n,). Units: m, N, Nm, s, rad, W.

Drake's Systems use these functions. `drakearm.model.muscle_lanes` has the same time step for many arms side by side;
`drakearm.muscle.compiled` explains why both exist.
"""

import math

import numpy as np

from drakearm.errors import EquilibriumError, StateError
from drakearm.model.arm import Arm
from drakearm.model.paths import count_slopes, evaluate_path_lanes, evaluate_paths, make_path_pieces
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

RESTING_ACTIVATION = 0.05  # of a muscle for which the user gives no activation
LARGEST_STATE = 1e6  # rad or rad/s: an arm that moves further or faster is a simulation that diverges
_STRONGEST = 100.0  # times max_isometric_force, of a resting muscle: arm14 has 6 at most; any fiber would tear


@compiled
def muscle_geometry(q, muscles, paths):
    """Musculotendon lengths (n,) and moment arms (n, n_q), both in m, at joint angles q (n_q,)."""
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
    """Tendon force (N) of a muscle with a compliant or a rigid tendon."""
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
def tendon_forces_of_arms(fibers, arm_state, muscles, paths):
    """Tendon forces (N, n) of N arms; fibers: (N, 2 n), arm_state: (N, 2 n_q)."""
    force = np.empty((len(fibers), len(muscles)))
    for k in range(len(fibers)):
        force[k] = tendon_forces(fibers[k], arm_state[k], muscles, paths)[0]
    return force


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
    """Advances the muscles' state in place by one time step, and writes the generalized force to hold during the step.

    Returns whether all excitations are finite, and q and v at most LARGEST_STATE; if not, the result is meaningless.

    state: activation, fiber length, fiber length one step earlier, fiber velocity, each (n,), one after the other.
    tau (n_q,): the generalized force. arm_state: at the start of the step.

    The joint angles at the end of the step are extrapolated with the present speeds. The held force is the mean of the
    forces at the start and at the end. Activation, fiber length and held force are of second order in the time step.
    With a rigid tendon the held force is of first order only, because its damping lags by half a step.
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
    for i in range(n):
        if not math.isfinite(excitation[i]):
            return False
    for j in range(2 * n_q):
        if not abs(arm_state[j]) <= LARGEST_STATE:
            return False
    return True


@compiled
def muscle_report(fibers, velocity, excitation, arm_state, muscles, paths):
    """Further outputs (5, n): active force, passive force, fiber power, tendon power, metabolic power of each muscle.

    velocity: of the fibers, (n,), m/s. The two forces act along the fiber.
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


@compiled
def metabolic_powers_of_arms(fibers, velocity, excitation, arm_state, strength, muscles, paths):
    """Metabolic powers (N, n) of the muscles of N arms; fibers: (N, 2 n), velocity, excitation, strength: (N, n)."""
    power, own = np.empty_like(strength), muscles.copy()
    for k in range(len(fibers)):
        for i in range(len(muscles)):
            own[i].max_isometric_force = muscles[i].max_isometric_force * strength[k, i]
        power[k] = muscle_report(fibers[k], velocity[k], excitation[k], arm_state[k], own, paths)[4]
    return power


@compiled
def _equilibrium(activation, q, muscles, paths, pieces, length, slope, force):
    """Writes fiber lengths and tendon forces in equilibrium, (n, N), at N postures q (n_q, N). activation: (N, n)."""
    evaluate_path_lanes(q, paths, pieces, length, slope)
    for i in range(len(muscles)):
        m = muscle_parameters(muscles[i], muscles[i].model_code)
        for k in range(q.shape[1]):
            fiber = equilibrium_fiber_length(activation[k, i], length[i, k], m)
            force[i, k] = muscle_force(activation[k, i], fiber, length[i, k], 0.0, m)
            length[i, k] = fiber


def require_state(what: str, values: np.ndarray, shape: tuple[int, ...]) -> None:
    """Raises StateError unless the values have this shape and are finite and at most LARGEST_STATE.

    what: their name in the message.
    """
    if np.shape(values) != shape or not (np.abs(values) <= LARGEST_STATE).all():
        size = " x ".join(map(str, shape))
        raise StateError(f"The {what} are {_listed(values)}: expected {size} finite numbers up to {LARGEST_STATE:g}.")


def equilibrium_fiber_lengths(arm: Arm, q: np.ndarray, activation: np.ndarray) -> np.ndarray:
    """Fiber lengths (N, n) of resting muscles at joint angles q (N, n_q), rad, and activations (n,) or (N, n).

    A fiber and its compliant tendon then exert the same force. Raises EquilibriumError, which names the muscles, where
    even the shortest fiber leaves the tendon slack, and where a muscle is stretched until it would tear.
    """
    muscles, paths, count = arm.muscle_table, arm.path_table, len(q)
    activation = np.array(np.broadcast_to(activation, (count, len(muscles))))
    pieces, slope = make_path_pieces(paths, count), np.empty((count_slopes(paths), count))
    length, force = np.empty((2, len(muscles), count))
    _equilibrium(activation, np.ascontiguousarray(q.T), muscles, paths, pieces, length, slope, force)
    ratio = force / muscles["max_isometric_force"][:, None]
    for impossible, reason in (
        (np.isnan(length), "the path is so short that even the shortest fiber leaves the tendon slack"),
        (ratio > _STRONGEST, f"the path is so long that the force would be over {_STRONGEST:g} max_isometric_force"),
    ):
        if impossible.any():
            k = int(impossible.any(axis=0).argmax())
            names = [name for name, i in zip(arm.muscle_names, impossible[:, k], strict=True) if i]
            more = f" and {len(names) - 3} more" if len(names) > 3 else ""
            raise EquilibriumError(
                f"At joint angles {_listed(q[k])} rad {', '.join(names[:3])}{more} of {arm.name} cannot be in "
                f"equilibrium: {reason}."
            )
    return length.T


def _listed(values: np.ndarray) -> str:
    return np.array2string(np.asarray(values), precision=4, threshold=6, edgeitems=2, separator=", ")


def resting_states(arm: Arm, q: np.ndarray, activation: float | np.ndarray) -> np.ndarray:
    """The states (N, 4 n), as in `muscle_step`, of the muscles of N arms at rest at joint angles q (N, n_q).

    activation: one number for all muscles, (n,), or (N, n). Raises EquilibriumError if a muscle has no equilibrium, and
    StateError for arrays of another size or numbers that are not finite.
    """
    n, n_q = len(arm.muscles), len(arm.coordinates)
    require_state("joint angles", q, (len(q), n_q))
    given = np.asarray(activation, dtype=float)
    require_state("activations", given, given.shape if given.shape in ((), (len(q), n)) else (n,))
    fiber_length = equilibrium_fiber_lengths(arm, q, given)
    activations = np.broadcast_to(given, fiber_length.shape)
    return np.hstack([activations, fiber_length, fiber_length, np.zeros_like(fiber_length)])


def resting_state(arm: Arm, q: np.ndarray, activation: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`resting_states` of one arm at joint angles q (n_q,): state (4 n,), and the generalized force (n_q,), Nm."""
    require_state("joint angles", q, (len(arm.coordinates),))
    state = resting_states(arm, q[None, :], activation)[0]
    fibers, arm_state = state[: 2 * len(arm.muscles)], np.concatenate([q, np.zeros_like(q)])
    return state, tendon_forces(fibers, arm_state, arm.muscle_table, arm.path_table)[1]
