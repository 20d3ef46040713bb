"""The types of what the files of an arm hold, which pydantic checks: names, angles, lengths and points."""

from collections import Counter
from typing import Annotated

from pydantic import AfterValidator, Field

from drakearm.files.fields import Number


def _name(value: str) -> str:
    if not value.isprintable() or value != value.strip():
        raise ValueError("expected a name without control characters and without spaces around it")
    return value


def each_once(names: tuple[str, ...]) -> tuple[str, ...]:
    """Raises ValueError if there is no name, or one is given twice."""
    if not names:
        raise ValueError("expected at least one")
    for name, count in Counter(names).items():
        if count > 1:
            raise ValueError(f"{name} is given twice: expected every name once")
    return names


Name = Annotated[str, Field(min_length=1, max_length=100), AfterValidator(_name)]
Angle = Annotated[Number, Field(ge=-100.0, le=100.0)]  # rad
Length = Annotated[Number, Field(ge=-100.0, le=100.0)]  # m
Acceleration = Annotated[Number, Field(ge=-1000.0, le=1000.0)]  # m/s^2
Point = tuple[Name, tuple[Length, Length, Length]]  # a body, and the position in it
