"""What a movement is: where it starts and ends, how long it takes, its limits and its costs."""

from typing import Annotated

import numpy as np
from pydantic import ConfigDict, Field, field_validator
from pydantic.dataclasses import dataclass

from drakearm.model.reference import CONTROL_STEP
from drakearm.planning.costs import Cost

Angles = tuple[Annotated[float, Field(allow_inf_nan=False)], ...]
Limits = tuple[Annotated[float, Field(gt=0.0, allow_inf_nan=False)], ...]


@dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid"))
class Movement:
    """A movement from rest to rest, as a scenario file's section `movement` holds it.

    The joint limits are the skeleton's.
    """

    start_deg: Angles  # per coordinate
    target_deg: Angles  # per coordinate
    duration: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]  # s, whole control steps
    hold: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] = 0.05  # s of rest after the end
    knots: Annotated[int, Field(ge=5)] = 41  # of the collocation, evenly spaced
    speed_limit: Limits  # rad/s, per coordinate
    torque_limit: Limits  # Nm, per coordinate
    costs: Annotated[list[Cost], Field(min_length=1)]

    @field_validator("duration", "hold")
    @classmethod
    def _whole_steps(cls, seconds: float) -> float:
        steps = seconds / CONTROL_STEP
        if abs(steps - round(steps)) > 1e-6:
            raise ValueError(f"expected a whole number of control steps of {CONTROL_STEP} s")
        return seconds

    @property
    def start(self) -> np.ndarray:
        """Joint angles (n_q,) at the start, rad."""
        return np.deg2rad(self.start_deg)

    @property
    def target(self) -> np.ndarray:
        """Joint angles (n_q,) at the end, rad."""
        return np.deg2rad(self.target_deg)
