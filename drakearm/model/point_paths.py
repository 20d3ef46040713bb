"""Musculotendon lengths from a muscle's points and the surfaces between them, at any joint angles of the skeleton.

From each point to the next the path is a straight line, or the shortest way over the surface between them.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.errors import ArmError, shown
from drakearm.model.arm import Arm, Muscle
from drakearm.model.body_poses import Poses, body_poses
from drakearm.model.fields import Point
from drakearm.model.surface import Surface
from drakearm.model.wrapping import path_over_cylinder, path_over_sphere, turn_on_side

_ROUNDING = 1e-9  # over the radius: by how much a point may be inside of a surface
_UNDECIDED = 1e-6  # rad: how close to the axis of a cylinder a line leaves its side open


class PointPaths:
    """The lengths of some muscles of an arm, from their points. Call it with joint angles.

    Raises ArmError for a point inside a surface, and for a muscle whose side of a cylinder is undecided.
    """

    def __init__(self, plant: MultibodyPlant, arm: Arm, muscles: Sequence[Muscle], neutral: np.ndarray, file: Path):
        """plant: finalized, with the skeleton. neutral (n_q,): rad, decides the side of cylinders. file: for errors."""
        self._plant = plant
        self._arm, self._muscles, self._file = arm, muscles, file
        surfaces = {surface.name: surface for surface in arm.surfaces}
        self._pairs = [
            [
                _Pair(i, start, end, surfaces[name] if name else None)
                for i, (start, end, name) in enumerate(
                    zip(m.points, m.points[1:], m.wraps or [None] * (len(m.points) - 1), strict=False)
                )
            ]
            for m in muscles
        ]
        self._bodies = {body for pairs in self._pairs for pair in pairs for body in pair.bodies}
        poses = body_poses(plant, self._bodies, neutral[None, :])
        self._turns = {
            (muscle.name, pair.number): self._turn(muscle, pair, poses)
            for muscle, pairs in zip(muscles, self._pairs, strict=True)
            for pair in pairs
            if pair.surface is not None and pair.surface.type == "cylinder"
        }

    def __call__(self, q: np.ndarray) -> np.ndarray:
        """The lengths (N, n), m, of the n muscles at joint angles q (N, n_q), rad."""
        poses = body_poses(self._plant, self._bodies, q)
        lengths = np.zeros((len(q), len(self._muscles)))
        for i, (muscle, pairs) in enumerate(zip(self._muscles, self._pairs, strict=True)):
            for pair in pairs:
                lengths[:, i] += self._length(muscle, pair, poses, q)
        return lengths

    def _length(self, muscle: Muscle, pair: "_Pair", poses: dict[str, Poses], q: np.ndarray) -> np.ndarray:
        start, end = (poses[body].place(np.array(p)) for body, p in (pair.start, pair.end))
        if pair.surface is None:
            return np.linalg.norm(end - start, axis=1)
        surface, start, end = pair.surface, *pair.seen_from_surface(poses)
        self._require_outside(muscle, pair, (start, end), q)
        if surface.type == "cylinder":
            return path_over_cylinder(start, end, surface.radius, self._turns[muscle.name, pair.number]).length
        return path_over_sphere(start, end, surface.radius, _direction(surface)).length

    def _require_outside(
        self, muscle: Muscle, pair: "_Pair", ends: tuple[np.ndarray, np.ndarray], q: np.ndarray
    ) -> None:
        surface = pair.surface
        assert surface is not None
        axes = 2 if surface.type == "cylinder" else 3
        for number, end in enumerate(ends, start=pair.number + 1):
            depth = surface.radius * (1.0 - _ROUNDING) - np.linalg.norm(end[:, :axes], axis=1)
            if (worst := int(depth.argmax())) >= 0 and depth[worst] > 0.0:
                where = described_posture(self._arm.coordinates, q[worst])
                raise ArmError(
                    f"{shown(self._file)}: muscles.{muscle.name}: its point {number} is {1e3 * depth[worst]:.3g} mm "
                    f"inside of the {surface.type} {surface.name} at {where}: expected a point outside of it."
                )

    def _turn(self, muscle: Muscle, pair: "_Pair", poses: dict[str, Poses]) -> float:
        surface = pair.surface
        assert surface is not None
        (start,), (end,) = pair.seen_from_surface(poses)
        across = abs(start[0] * end[1] - start[1] * end[0]), np.hypot(*start[:2]) * np.hypot(*end[:2])
        opposite = start[:2] @ end[:2] < 0.0
        if surface.side is None and opposite and across[0] <= _UNDECIDED * across[1]:
            raise ArmError(
                f"{shown(self._file)}: muscles.{muscle.name}: the line from its point {pair.number + 1} to the next "
                f"crosses the axis of {surface.name}: expected a side of this surface, as in side: [1, 0, 0]."
            )
        return turn_on_side(start, end, _direction(surface))


def described_posture(coordinates: Sequence[str], q: np.ndarray) -> str:
    """Joint angles (n_q,), rad, as a text like "shoulder 10°, elbow 90°"."""
    return ", ".join(f"{name} {np.rad2deg(angle):.0f}°" for name, angle in zip(coordinates, q, strict=True))


class _Pair(NamedTuple):
    """Two consecutive points of a muscle, and the surface between them."""

    number: int  # of the first point, from 0
    start: Point
    end: Point
    surface: Surface | None

    @property
    def bodies(self) -> set[str]:
        return {self.start[0], self.end[0]} | ({self.surface.body} if self.surface else set())

    def seen_from_surface(self, poses: dict[str, Poses]) -> tuple[np.ndarray, np.ndarray]:
        """The two points, (N, 3) each, in the frame of the surface."""
        surface = self.surface
        assert surface is not None
        body, center, rotation = poses[surface.body], np.array(surface.center), surface.rotation
        start, end = (poses[b].place(np.array(p)) for b, p in (self.start, self.end))
        return (body.locate(start) - center) @ rotation, (body.locate(end) - center) @ rotation


def _direction(surface: Surface) -> np.ndarray | None:
    """The side of a surface in its own frame."""
    return None if surface.side is None else np.array(surface.side) @ surface.rotation
