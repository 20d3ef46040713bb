"""A movement to be planned: where it starts and ends, how long it takes, its limits and its costs."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Degrees, NonNegative, Positive, Whole
from drakearm.model.reference import CONTROL_STEP
from drakearm.planning.costs import Cost

_Duration = Annotated[Positive, Field(le=60.0)]  # s


@checked_dataclass(kw_only=True)
class Movement:
    """A movement that starts at rest. Its fields are those of the section `movement` of a scenario file.

    duration: one number, or the shortest and the longest allowed duration, between which that of least cost is found.
    end: "rest", at rest at the target, or "free", where only the costs bring the arm to the target.
    """

    start_deg: tuple[Degrees, ...]  # per coordinate
    target_deg: tuple[Degrees, ...]  # per coordinate
    duration: _Duration | tuple[_Duration, _Duration]  # s, whole control steps
    end: Literal["rest", "free"] = "rest"
    hold: Annotated[NonNegative, Field(le=60.0)] = 0.05  # s of rest after the end
    knots: Annotated[Whole, Field(ge=5, le=200)] = 21  # of the collocation, evenly spaced
    angle_limit_deg: tuple[tuple[Degrees, Degrees], ...] | None = None  # per coordinate; default: joint limits
    speed_limit: tuple[Positive, ...]  # rad/s, per coordinate
    torque_limit: tuple[Positive, ...]  # Nm, per coordinate
    clearance: Positive = 0.01  # m, from an obstacle at the knots; between them at least half of it
    costs: Annotated[list[Cost], Field(min_length=1, max_length=50)]

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
            raise ValueError("hold: expected 0 if the end is free, because the arm may not be at rest there")
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
