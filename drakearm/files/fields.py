"""The types of what files hold, which pydantic checks: numbers with limits, and names."""

import unicodedata
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field

from drakearm.errors import UNPRINTABLE

LARGEST = 1e12  # of any number, in SI units: larger ones overflow where they are squared and summed
_SMALLEST = 1e-12  # of a positive number: smaller ones overflow where it divides


def _number(value: Any) -> Any:
    """Refuses true, false and text, which pydantic would convert to numbers."""
    if isinstance(value, bool | np.bool_ | str | bytes):
        raise ValueError("expected a number")
    return value


def _not_tiny(value: float) -> float:
    if value < _SMALLEST:
        raise ValueError(f"expected at least {_SMALLEST}")
    return value


def _file_name(value: str) -> str:
    """Refuses a name that is no good name for a folder, or that would lie outside of its folder."""
    if not value.strip() or value.strip(". ") == "" or value != value.strip():
        raise ValueError("expected a name, without spaces around it")
    if len(value) > 100 or len(value.encode("utf-8", "surrogatepass")) > 200:
        raise ValueError("expected a name of at most 100 characters")
    if "/" in value or "\\" in value or any(unicodedata.category(c) in UNPRINTABLE for c in value):
        raise ValueError("expected a name without slashes, backslashes and control characters")
    return value


def _plain_text(value: str) -> str:
    """Refuses characters that a terminal would obey instead of showing them."""
    if any(unicodedata.category(c) in UNPRINTABLE and c not in "\n\t" for c in value):
        raise ValueError("expected text without control characters")
    return value


Number = Annotated[float, BeforeValidator(_number)]
Finite = Annotated[Number, Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[Number, Field(gt=0.0, le=LARGEST), AfterValidator(_not_tiny)]
NonNegative = Annotated[Number, Field(ge=0.0, le=LARGEST)]
Fraction = Annotated[Number, Field(ge=0.0, le=1.0)]
Whole = Annotated[int, BeforeValidator(_number)]  # a whole number
Degrees = Annotated[Number, Field(ge=-540.0, le=540.0)]  # of a joint: more than any turns
Vector = tuple[Finite, Finite, Finite]

FileName = Annotated[str, AfterValidator(_file_name)]  # becomes the name of a folder
PlainText = Annotated[str, Field(max_length=2000), AfterValidator(_plain_text)]  # is shown in a terminal

STRICT = ConfigDict(extra="forbid")  # of a dataclass: a field that it does not have is an error
