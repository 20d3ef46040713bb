"""An obstacle: a cylinder in the way of the arm. Plans go around it, replays show it."""

from typing import Annotated

import numpy as np
from pydantic import Field, field_validator
from pydrake.geometry import Cylinder
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant

from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Number, Positive, Vector

_Place = Annotated[Number, Field(ge=-100.0, le=100.0)]  # m
_Length = Annotated[Positive, Field(le=100.0)]  # m
_COLOR = np.array([0.80, 0.36, 0.24, 1.0])


@checked_dataclass(kw_only=True)
class Obstacle:
    """A cylinder at rest in the world. Lengths in m. For the planner it has no ends: it is infinitely long."""

    position: tuple[_Place, _Place, _Place]  # p_WO, of its middle
    axis: Vector = (0.0, 0.0, 1.0)  # in the world; arm14 moves in the plane across z
    radius: _Length
    length: _Length = 0.3  # for drawing only

    @field_validator("axis")
    @classmethod
    def _has_direction(cls, axis: Vector) -> Vector:
        if not 1e-6 <= np.linalg.norm(axis) <= 1e6:
            raise ValueError("expected a vector with a length from 1e-6 to 1e6, which is not zero")
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
