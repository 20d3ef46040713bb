"""A surface over which muscles wrap: a cylinder or a sphere that is fixed to a body."""

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Positive
from drakearm.model.fields import Name, Position

_PARALLEL = 1e-3  # sine of the least angle between the side and the axis of a cylinder


@checked_dataclass()
class Surface:
    """A cylinder without ends, or a sphere. Units: m.

    side: on which side of its center muscles pass. Without it they pass a cylinder on the side that is shorter when the
    joint angles are 0, or as near to 0 as their ranges allow, and stay there; on a sphere they slide to the shorter
    side.
    """

    name: Name
    type: Literal["cylinder", "sphere"]
    body: Name
    center: Position  # in the frame of the body
    radius: Annotated[Positive, Field(le=100.0)]
    axis: Position | None = None  # of a cylinder, a direction in that frame
    side: Position | None = None  # a direction in that frame

    @field_validator("axis", "side")
    @classmethod
    def _has_a_direction(cls, value: Any) -> Any:
        if value is not None and not np.linalg.norm(value) > 0.0:
            raise ValueError("expected a direction, which is not 0")
        return value

    @model_validator(mode="after")
    def _fits_its_type(self) -> Self:
        if self.type == "sphere" and self.axis is not None:
            raise ValueError("axis: a sphere has none: expected no axis, or type: cylinder")
        if self.type == "cylinder" and self.axis is None:
            raise ValueError("axis: is missing, but required of a cylinder")
        if self.axis is not None and self.side is not None:
            sine = np.linalg.norm(np.cross(self.axis, self.side))
            if not sine > _PARALLEL * np.linalg.norm(self.axis) * np.linalg.norm(self.side):
                raise ValueError("side: expected a direction across the axis, not along it")
        return self

    @property
    def rotation(self) -> np.ndarray:
        """The orientation R_BS (3, 3) of a frame S of the surface in its body, whose z axis is along the cylinder."""
        if self.axis is None:
            return np.eye(3)
        z = np.array(self.axis) / np.linalg.norm(self.axis)
        x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
        x /= np.linalg.norm(x)
        return np.stack([x, np.cross(z, x), z], axis=1)
