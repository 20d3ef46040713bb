"""Equilibria of the whole arm: the excitations with which its muscles hold a posture."""

from typing import NamedTuple

import numpy as np

from drakearm.errors import EquilibriumError
from drakearm.model.arm import Arm
from drakearm.model.joint_ranges import require_in_ranges
from drakearm.model.musculature import (
    RESTING_ACTIVATION,
    equilibrium_fiber_lengths,
    muscle_geometry,
    require_state,
    resting_state,
    sound_activations,
)
from drakearm.model.skeleton import gravity_torque, neutral_posture, skeleton_plant
from drakearm.model.static_optimization import negligible_reserve, static_activations, steady_force
from drakearm.model.torque_arm import MakeTorqueArm
from drakearm.model.weakness import weakness
from drakearm.muscle.compiled import compiled

_ITERATIONS = 20  # of Newton's method at most; it usually needs three
_EXACT = 1e-10  # Nm, error of the torques
_ROUNDING = 1e-6  # error of the torques, over what the muscles exert with and against each other


class Equilibrium(NamedTuple):
    """A state of the whole arm in which nothing moves. n muscles, n_q coordinates."""

    q: np.ndarray  # (n_q,) rad
    excitation: np.ndarray  # (n,)
    activation: np.ndarray  # (n,), equal to the excitation
    fiber_length: np.ndarray  # (n,) m
    torque: np.ndarray  # (n_q,) Nm, of the muscles on the joints, against gravity


@compiled
def _forces_at_rest(activation, length, muscles):
    """Tendon forces (n,), N, of resting muscles, and their slopes with respect to activation. length (n,): paths, m."""
    force, slope = np.empty(len(muscles)), np.empty(len(muscles))
    for i in range(len(muscles)):
        m = muscles[i]
        force[i], slope[i], _ = steady_force(activation[i], length[i], 0.0, m.optimal_fiber_length, m)
    return force, slope


def find_equilibrium(
    arm: Arm,
    q: np.ndarray,
    load_mass: float = 0.0,
    *,
    torque: np.ndarray | None = None,
    strength: float | np.ndarray = 1.0,
    least: float | np.ndarray = 0.0,
) -> Equilibrium:
    """The smallest excitations with which the muscles hold joint angles q (n_q,), rad, with load_mass (kg) in the hand.

    torque: what the muscles exert on the joints (n_q,), Nm, if they hold something else than the arm and the load.
    strength: factors of the maximum isometric forces, one number or (n,). least: no activation is smaller than this,
    one number or (n,), 0..1: with more than 0 muscles work against each other (co-contraction). Static optimization
    (`static_activations`) finds the excitations, then Newton's method makes the torques exact. Raises EquilibriumError
    if the muscles are too weak, if `least` is too much, or if the posture is impossible for a muscle. Raises StateError
    if q, torque or least has another size or is not finite, if least is outside of 0..1, and if a joint is outside of
    its range by more than 0.15 rad.
    """
    q = np.asarray(q, dtype=float)
    n, n_q = len(arm.muscles), len(arm.coordinates)
    require_state("joint angles", q, (n_q,))
    require_in_ranges(arm, q)
    muscles, paths, rest = arm.muscle_table.copy(), arm.path_table, np.zeros(n_q)
    muscles["max_isometric_force"] *= strength
    lowest = muscles["minimum_activation"] = sound_activations(arm, least)
    # Before the torques: what a muscle exerts that is slack or torn has no meaning.
    equilibrium_fiber_lengths(arm, q[None, :], lowest)
    if torque is None:
        torque = gravity_torque(MakeTorqueArm(arm, load_mass), q)
    torque = np.asarray(torque, dtype=float)
    require_state("torques", torque, (n_q,))
    activation, reserve = static_activations(q, rest, torque, np.full(n, 0.1), np.eye(len(q)), muscles, paths)
    if not np.abs(reserve).max() <= negligible_reserve(q, muscles, paths):
        raise _too_weak(arm, q, reserve, torque, lowest)
    length, moment_arm = muscle_geometry(q, muscles, paths)
    for _ in range(_ITERATIONS):
        force, slope = _forces_at_rest(activation, length, muscles)
        missing = torque - force @ moment_arm
        if np.abs(missing).max() < _EXACT:
            break
        free = (activation > lowest) & (activation < 1.0)
        gain = moment_arm[free] * slope[free, None]
        activation[free] += np.linalg.lstsq(gain.T, missing, rcond=None)[0]
        activation = np.clip(activation, lowest, 1.0)
    fiber_length = equilibrium_fiber_lengths(arm, q[None, :], activation)[0]
    if not np.abs(missing).max() <= _ROUNDING * (force @ np.abs(moment_arm)).max():
        raise _too_weak(arm, q, missing, torque, lowest)
    return Equilibrium(q, activation, activation.copy(), fiber_length, force @ moment_arm)


def neutral_state(arm: Arm) -> tuple[np.ndarray, np.ndarray]:
    """The muscles' state (4 n,) at rest in the neutral posture, and the generalized force (n_q,), as `resting_state`.

    If a muscle has no equilibrium there, all fibers are at their optimal lengths, and the force is 0.
    """
    try:
        return resting_state(arm, neutral_posture(skeleton_plant(arm)), RESTING_ACTIVATION)
    except EquilibriumError:
        fiber_length = arm.muscle_table["optimal_fiber_length"]
        still = np.zeros(len(arm.muscles))
        state = np.concatenate([still + RESTING_ACTIVATION, fiber_length, fiber_length, still])
        return state, np.zeros(len(arm.coordinates))


def _too_weak(arm: Arm, q: np.ndarray, missing: np.ndarray, torque: np.ndarray, lowest: np.ndarray) -> EquilibriumError:
    """The error for joint torques, (n_q,), Nm, of which some are missing. lowest: activations (n,) that are allowed."""
    j = int(np.abs(missing).argmax())
    raised = (lowest > arm.muscle_table["minimum_activation"]).any()
    return EquilibriumError(
        f"The muscles of {arm.name} cannot hold the joint angles {np.round(q, 4).tolist()} rad"
        f"{' with these least activations' if raised else ''}: "
        f"{weakness(arm.coordinates[j], missing[j], torque[j])}."
    )
