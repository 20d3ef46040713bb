"""The types of what the files of an arm hold, which pydantic checks: names, angles, lengths and points."""

from collections import Counter
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field

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


def _three(value: Any) -> Any:
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise ValueError("expected three numbers, as in [0, 0, 0.1]")
    return value


def _body_and_position(value: Any) -> Any:
    pair = isinstance(value, list | tuple) and len(value) == 2
    if not pair or not isinstance(value[1], list | tuple) or len(value[1]) != 3:
        raise ValueError("expected a body and a position in it, as in [hand, [0, 0, 0.1]]")
    return value


Name = Annotated[str, Field(min_length=1, max_length=100), AfterValidator(_name)]
Angle = Annotated[Number, Field(ge=-100.0, le=100.0)]  # rad
Length = Annotated[Number, Field(ge=-100.0, le=100.0)]  # m
Acceleration = Annotated[Number, Field(ge=-1000.0, le=1000.0)]  # m/s^2
Position = Annotated[tuple[Length, Length, Length], BeforeValidator(_three)]  # also a direction
Point = Annotated[tuple[Name, Position], BeforeValidator(_body_and_position)]
