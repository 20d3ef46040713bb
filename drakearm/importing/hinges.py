"""Finds the axes of a joint from the relative poses of its two bodies: a product of exponentials (Brockett, 1984).

This serves all programs and all kinds of joints: what is rotations about one axis per coordinate is found whatever it
is called, and what is not is found out.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations

import numpy as np
from scipy.spatial.transform import Rotation

Pose = Callable[[np.ndarray], np.ndarray]  # coordinates (k,) of a joint -> pose (4, 4) of the child in the parent

_SMALL = 1e-6  # rad and m
_POSTURES = 12


@dataclass(frozen=True)
class Hinge:
    """A rotation about a line that is fixed in the parent while all coordinates are at the base."""

    coordinate: int
    axis: np.ndarray  # (3,), unit
    point: np.ndarray  # (3,), on the axis


def find_hinges(pose: Pose, base: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> tuple[Hinge, ...] | None:
    """The hinges from parent to child, or None if the joint is something else.

    The pose of the child is the product of the hinges' rotations by q - base, times its pose at the base.
    """
    start = pose(base)
    hinges = []
    for i in range(len(base)):
        turned = base.copy()
        turned[i] += _turn(base[i], lower[i], upper[i])
        hinge = _hinge(i, pose(turned) @ np.linalg.inv(start), turned[i] - base[i], start[:3, 3])
        if hinge is None:
            return None
        hinges.append(hinge)
    q = np.random.default_rng(0).uniform(lower, upper, (_POSTURES, len(base)))
    expected = [pose(x) for x in q]
    for ordered in permutations(hinges):
        if all(np.allclose(moved(ordered, x - base) @ start, e, atol=_SMALL) for x, e in zip(q, expected, strict=True)):
            return ordered
    return None


def moved(hinges: tuple[Hinge, ...], angles: np.ndarray) -> np.ndarray:
    """The product of the hinges' rotations, (4, 4). angles (k,): of the coordinates, relative to the base."""
    result = np.eye(4)
    for hinge in hinges:
        rotation = Rotation.from_rotvec(hinge.axis * angles[hinge.coordinate]).as_matrix()
        step = np.eye(4)
        step[:3, :3] = rotation
        step[:3, 3] = hinge.point - rotation @ hinge.point
        result = result @ step
    return result


def _turn(base: float, lower: float, upper: float) -> float:
    """An angle to turn by: into the wider side of the range."""
    room = upper - base if upper - base >= base - lower else lower - base
    return float(np.clip(0.5 * room, -1.0, 1.0))


def _hinge(coordinate: int, motion: np.ndarray, angle: float, near: np.ndarray) -> Hinge | None:
    """The axis of a motion (4, 4) that turns by an angle, at the point closest to `near`; None if it is none."""
    vector = Rotation.from_matrix(motion[:3, :3]).as_rotvec()
    if not abs(angle) > 0.0 or abs(np.linalg.norm(vector) - abs(angle)) > _SMALL:
        return None
    axis = vector / np.linalg.norm(vector) * np.sign(angle)
    fixed = np.eye(3) - motion[:3, :3]  # fixed @ point = translation, for points on the axis
    point = near + np.linalg.pinv(fixed, rcond=1e-6) @ (motion[:3, 3] - fixed @ near)
    if np.linalg.norm(fixed @ point - motion[:3, 3]) > _SMALL:
        return None
    return Hinge(coordinate, axis, point)
