"""Muscles at rest in a posture that something else holds: the torques that they exert, and their stiffness."""

from typing import NamedTuple

import numpy as np

from drakearm.model.arm import Arm
from drakearm.model.joint_ranges import require_in_ranges
from drakearm.model.linearization import linearize_muscles
from drakearm.model.musculature import muscle_geometry, require_state, resting_state, resting_states, tendon_forces


class Isometric(NamedTuple):
    """What muscles exert at rest. n muscles, n_q coordinates; for N postures each array has N as its first axis."""

    torque: np.ndarray  # (n_q,) Nm, of all muscles on the joints
    joint_moment: np.ndarray  # (n, n_q) Nm, of each muscle at each joint
    tendon_force: np.ndarray  # (n,) N
    fiber_length: np.ndarray  # (n,) m


def isometric_torque(arm: Arm, q: np.ndarray, activation: float | np.ndarray) -> Isometric:
    """The torques of resting muscles at joint angles q, (n_q,) or (N, n_q), rad, whose tendons are in equilibrium.

    Gravity does not matter: the joints are held. activation: 0..1, one number for all muscles, (n,), or (N, n); it
    becomes at least minimum_activation. Raises EquilibriumError if a muscle has no equilibrium, and StateError for
    arrays of another size, numbers that are not finite, activations outside of 0..1, and joints that are outside of
    their ranges by more than 0.15 rad.
    """
    q, n, n_q = np.asarray(q, dtype=float), len(arm.muscles), len(arm.coordinates)
    postures = np.atleast_2d(q)
    require_state("joint angles", q, (n_q,) if q.ndim < 2 else (len(q), n_q))
    require_in_ranges(arm, postures)
    fibers = resting_states(arm, postures, activation)[:, : 2 * n]
    force, moment_arm = np.empty((len(postures), n)), np.empty((len(postures), n, n_q))
    for k, angles in enumerate(postures):
        arm_state = np.concatenate([angles, np.zeros(n_q)])
        force[k], _ = tendon_forces(fibers[k], arm_state, arm.muscle_table, arm.path_table)
        _, moment_arm[k] = muscle_geometry(angles, arm.muscle_table, arm.path_table)
    joint_moment = moment_arm * force[:, :, None]
    found = Isometric(joint_moment.sum(axis=1), joint_moment, force, fibers[:, n:])
    return found if q.ndim == 2 else Isometric(*(values[0] for values in found))


def joint_stiffness(arm: Arm, q: np.ndarray, activation: float | np.ndarray) -> np.ndarray:
    """The stiffness (n_q, n_q), Nm/rad, that muscles give to the joints at q (n_q,), rad.

    It is minus the derivative of the torques of `isometric_torque` by the joint angles, at constant activations: row i
    is the torque of joint i, column j the angle of joint j. It has two parts. The first is the stiffness of the muscles
    times their squared moment arms, with fiber and tendon in series, so it is the stiffness after a slow change. The
    other one is their force times the change of their moment arms. Neither reflexes nor the history of the fibers are
    in it (short-range stiffness). It is symmetric, because constant activations conserve energy. Raises the errors of
    `isometric_torque`.
    """
    q, n, n_q = np.asarray(q, dtype=float), len(arm.muscles), len(arm.coordinates)
    require_state("joint angles", q, (n_q,))
    require_in_ranges(arm, q)
    state, _ = resting_state(arm, q, activation)
    arm_state = np.concatenate([q, np.zeros(n_q)])
    _, jacobian = linearize_muscles(state[: 2 * n], state[:n], arm_state, arm.muscle_table, arm.path_table)
    fiber, angle = slice(n, 2 * n), slice(3 * n, 3 * n + n_q)
    # In equilibrium the fibers stand still: how they follow the angles is where their velocity stays 0.
    by_fiber, by_angle = jacobian[fiber, fiber].diagonal(), jacobian[fiber, angle]
    follows = by_fiber < 0.0  # not with a rigid tendon, where the angles alone determine the fiber
    fiber_by_angle = np.zeros_like(by_angle)
    fiber_by_angle[follows] = -by_angle[follows] / by_fiber[follows, None]
    torque = slice(4 * n, None)
    stiffness: np.ndarray = -(jacobian[torque, angle] + jacobian[torque, fiber] @ fiber_by_angle)
    return stiffness
