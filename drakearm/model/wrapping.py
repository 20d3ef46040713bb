"""Lengths of the shortest paths between two points over a cylinder or a sphere, in closed form.

Both are the same problem in a plane: the plane across the cylinder, or the plane through both points and the center of
the sphere. There the path is a straight line, an arc, and a straight line. The lines touch the circle, so that length
and slope are continuous where the path begins to touch the surface. Over a cylinder the path is a helix, whose length
follows from Pythagoras. At most half a turn is in contact with the surface. Points must be on the surface or outside of
it.
"""

from typing import NamedTuple

import numpy as np


class WrappedPath(NamedTuple):
    """The paths of N pairs of points."""

    length: np.ndarray  # (N,) m
    contact: np.ndarray  # (N,) rad: the angle of the arc; not positive where the straight line is free


def path_over_cylinder(p: np.ndarray, q: np.ndarray, radius: float, turn: float) -> WrappedPath:
    """The paths from p to q, (N, 3), over an endless cylinder around the z axis. Units: m.

    turn: 1 if the path goes counterclockwise around the z axis, -1 if clockwise.
    """
    angle = turn * (np.arctan2(q[:, 1], q[:, 0]) - np.arctan2(p[:, 1], p[:, 0]))
    flat, contact = _around_circle(np.hypot(p[:, 0], p[:, 1]), np.hypot(q[:, 0], q[:, 1]), angle, radius)
    return _unless_free(p, q, np.hypot(flat, q[:, 2] - p[:, 2]), contact)


def path_over_sphere(p: np.ndarray, q: np.ndarray, radius: float, side: np.ndarray | None) -> WrappedPath:
    """The paths from p to q, (N, 3), over a sphere around the origin. Units: m.

    side: a direction (3,), on whose side of the center the path stays. None: the path takes the shorter way.
    """
    from_center, to_center = np.linalg.norm(p, axis=1), np.linalg.norm(q, axis=1)
    angle = np.arctan2(np.linalg.norm(np.cross(p, q), axis=1), np.einsum("ij,ij->i", p, q))
    if side is not None:
        middle = p / from_center[:, None] + q / to_center[:, None]
        angle = np.where(middle @ side < 0.0, 2.0 * np.pi - angle, angle)
    return _unless_free(p, q, *_around_circle(from_center, to_center, angle, radius))


def turn_on_side(p: np.ndarray, q: np.ndarray, side: np.ndarray | None) -> float:
    """The turn of a path around the z axis, from p (3,) to q (3,), that is on a side (3,), or else the shorter one."""
    start, end = np.arctan2(p[1], p[0]), np.arctan2(q[1], q[0])
    angle = (end - start) % (2.0 * np.pi)  # counterclockwise
    if side is None:
        return 1.0 if angle <= np.pi else -1.0
    middle = start + 0.5 * angle
    return 1.0 if side[0] * np.cos(middle) + side[1] * np.sin(middle) >= 0.0 else -1.0


def _around_circle(p: np.ndarray, q: np.ndarray, angle: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Length (m) and contact (rad) around a circle. p, q: distances (m) from its center. angle (rad): between them."""
    p, q = np.maximum(p, radius), np.maximum(q, radius)  # what is below is rounding: the caller checks that
    contact = angle - np.arccos(radius / p) - np.arccos(radius / q)
    contact = np.pi - (np.pi - contact) % (2.0 * np.pi)  # in (-pi, pi]
    return np.sqrt(p**2 - radius**2) + np.sqrt(q**2 - radius**2) + radius * contact, contact


def _unless_free(p: np.ndarray, q: np.ndarray, length: np.ndarray, contact: np.ndarray) -> WrappedPath:
    return WrappedPath(np.where(contact > 0.0, length, np.linalg.norm(q - p, axis=1)), contact)
