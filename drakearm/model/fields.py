"""The types of the numbers in files, which pydantic checks."""

from typing import Annotated

from pydantic import ConfigDict, Field

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Vector = tuple[Finite, Finite, Finite]

STRICT = ConfigDict(extra="forbid")  # of a dataclass: a field that it does not have is an error
