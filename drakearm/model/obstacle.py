"""An obstacle: a cylinder in the way of the arm. Plans go around it, replays show it."""

import numpy as np
from pydantic import field_validator
from pydantic.dataclasses import dataclass
from pydrake.geometry import Cylinder
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant

from drakearm.files.fields import STRICT, Positive, Vector

_COLOR = np.array([0.80, 0.36, 0.24, 1.0])


@dataclass(frozen=True, kw_only=True, config=STRICT)
class Obstacle:
    """A cylinder at rest in the world. Lengths in m. For the planner it has no ends: it is infinitely long."""

    position: Vector  # p_WO, of its middle
    axis: Vector = (0.0, 0.0, 1.0)  # in the world; arm14 moves in the plane across z
    radius: Positive
    length: Positive = 0.3  # for drawing only

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
    """Fixes an obstacle's shape to the world of a plant that is registered with a SceneGraph and not finalized yet.

    The shape is only drawn. There are no contact forces: only the plan keeps the arm away from it.
    """
    X_WO = RigidTransform(RotationMatrix.MakeFromOneVector(obstacle.direction, 2), np.array(obstacle.position))
    shape = Cylinder(obstacle.radius, obstacle.length)
    plant.RegisterVisualGeometry(plant.world_body(), X_WO, shape, "obstacle", _COLOR)
