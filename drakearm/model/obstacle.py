"""An obstacle: a cylinder in the way of the arm, that a plan goes around and a replay shows."""

from typing import Annotated

import numpy as np
from pydantic import ConfigDict, Field, field_validator
from pydantic.dataclasses import dataclass
from pydrake.geometry import Cylinder
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Vector = tuple[Finite, Finite, Finite]

_COLOR = np.array([0.80, 0.36, 0.24, 1.0])


@dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid"))
class Obstacle:
    """A cylinder at rest in the world. Lengths in m. For the planner it has no ends: it crosses the whole plane."""

    position: Vector  # of its middle, p_WO
    axis: Vector = (0.0, 0.0, 1.0)  # in the world; arm14 moves in the plane across z
    radius: Positive
    length: Positive = 0.3  # as it is drawn

    @field_validator("axis")
    @classmethod
    def _has_direction(cls, axis: Vector) -> Vector:
        if not np.linalg.norm(axis) > 0.0:
            raise ValueError("expected a vector that is not zero")
        return axis

    @property
    def direction(self) -> np.ndarray:
        """The axis as a unit vector (3,)."""
        return np.array(self.axis) / np.linalg.norm(self.axis)


def add_obstacle(plant: MultibodyPlant, obstacle: Obstacle) -> None:
    """Fixes an obstacle's shape to the world of a plant that is a source of a SceneGraph and not finalized yet.

    It is drawn but it does not push: what keeps the arm away from it is the plan.
    """
    X_WO = RigidTransform(RotationMatrix.MakeFromOneVector(obstacle.direction, 2), np.array(obstacle.position))
    shape = Cylinder(obstacle.radius, obstacle.length)
    plant.RegisterVisualGeometry(plant.world_body(), X_WO, shape, "obstacle", _COLOR)
