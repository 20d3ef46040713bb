"""What a movement is: where it starts and ends, how long it takes, its limits and its costs."""

from typing import Annotated, Literal

import numpy as np
from pydantic import ConfigDict, Field, field_validator, model_validator
from pydantic.dataclasses import dataclass

from drakearm.model.reference import CONTROL_STEP
from drakearm.planning.cost import Cost

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Limits = tuple[Positive, ...]


@dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid"))
class Movement:
    """A movement that starts at rest, as a scenario file's section `movement` holds it.

    duration: fixed, or free between a shortest and a longest; then the one of least cost is found. end: at rest at the
    target, or free, where the costs alone draw the arm to the target.
    """

    start_deg: tuple[Finite, ...]  # per coordinate
    target_deg: tuple[Finite, ...]  # per coordinate
    duration: Positive | tuple[Positive, Positive]  # s, whole control steps
    end: Literal["rest", "free"] = "rest"
    hold: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] = 0.05  # s of rest after the end
    knots: Annotated[int, Field(ge=5)] = 21  # of the collocation, evenly spaced
    angle_limit_deg: tuple[tuple[Finite, Finite], ...] | None = None  # per coordinate; else the skeleton's
    speed_limit: Limits  # rad/s, per coordinate
    torque_limit: Limits  # Nm, per coordinate
    clearance: Positive = 0.01  # m, from an obstacle, at the knots; half of it everywhere
    costs: Annotated[list[Cost], Field(min_length=1)]

    @field_validator("duration", "hold")
    @classmethod
    def _whole_steps(cls, seconds: float | tuple[float, float]) -> float | tuple[float, float]:
        for time in seconds if isinstance(seconds, tuple) else (seconds,):
            steps = time / CONTROL_STEP
            if abs(steps - round(steps)) > 1e-6:
                raise ValueError(f"expected a whole number of control steps of {CONTROL_STEP} s")
        if isinstance(seconds, tuple) and seconds[0] >= seconds[1]:
            raise ValueError("expected a shortest duration and a longer one")
        return seconds

    @model_validator(mode="after")
    def _holds_at_rest(self) -> "Movement":
        if self.end == "free" and self.hold > 0.0:
            raise ValueError("hold: expected 0 where the end is free, for the arm may not be at rest there")
        return self

    @property
    def start(self) -> np.ndarray:
        """Joint angles (n_q,) at the start, rad."""
        return np.deg2rad(self.start_deg)

    @property
    def target(self) -> np.ndarray:
        """Joint angles (n_q,) at the end, rad."""
        return np.deg2rad(self.target_deg)


def in_degrees(angles: tuple[float, ...]) -> str:
    """Joint angles in degrees as messages show them."""
    return "(" + ", ".join(f"{angle:g}" for angle in angles) + ") deg"
