"""The terms of a path function as frozen dataclasses: B-splines of one coordinate, or of two or three together."""

from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, ValidationInfo, field_validator

from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.model.bspline import Spline
from drakearm.model.fields import Angle, Length, Name, each_once

_CLOSEST_KNOTS = 1e-6  # rad
_LARGEST_MOMENT_ARM = 100.0  # m, as bounded by the coefficients of the spline, which can be far above the true one
_HIGHEST_DEGREE = 12  # of a path's spline: higher polynomials are not computed accurately
_MOST_COEFFICIENTS, _LONGEST = 100_000, 100.0  # of a tensor-product spline; m, each


Knots = Annotated[tuple[Angle, ...], Field(max_length=1000)]


def _nested(value: Any) -> Any:
    """Nested lists of numbers as nested tuples."""
    try:
        table = np.array(value)
    except ValueError:  # lists of different lengths
        table = np.array(None)
    if table.dtype.kind not in "iuf" or table.ndim not in (2, 3) or table.size > _MOST_COEFFICIENTS:
        raise ValueError(
            f"expected up to {_MOST_COEFFICIENTS} numbers in lists of equal lengths, one level of lists per coordinate"
        )
    if not (np.abs(table) <= _LONGEST).all():
        raise ValueError(f"expected finite numbers of at most {_LONGEST:g} m")
    return _tuples(table.tolist())


def _tuples(value: Any) -> Any:
    return tuple(_tuples(each) for each in value) if isinstance(value, list) else value


@checked_dataclass()
class PathTerm:
    """The part of a musculotendon length (m) that depends on one coordinate (rad).

    It is a B-spline, which continues linearly outside its knots.
    """

    coordinate: Name
    knots: Knots
    coefficients: Annotated[tuple[Length, ...], Field(max_length=1000)]

    @field_validator("coefficients")
    @classmethod
    def _fits_knots(cls, coefficients: tuple, info: ValidationInfo) -> tuple:
        if "knots" in info.data:  # else they have a problem of their own
            _require_spline(info.data["knots"], np.array(coefficients))
        return coefficients

    @property
    def coordinates(self) -> tuple[str, ...]:
        return (self.coordinate,)

    @property
    def spline(self) -> Spline:
        degree = len(self.knots) - len(self.coefficients) - 1
        return Spline(np.array(self.knots), np.array(self.coefficients), degree)

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """From the first to the last knot (rad) of each coordinate. Outside, the term is linear."""
        return (_range(self.knots, len(self.coefficients)),)


@checked_dataclass()
class TensorTerm:
    """The part of a musculotendon length (m) that depends on two or three coordinates (rad) together.

    It is a tensor-product B-spline: the sum of c_ab B_a(q_1) B_b(q_2), and for three coordinates accordingly, where the
    functions B of a coordinate are the B-splines on its knots. They continue linearly outside. coefficients: nested
    lists, whose first index belongs to the first coordinate.
    """

    coordinates: Annotated[tuple[Name, ...], Field(min_length=2, max_length=3), AfterValidator(each_once)]
    knots: tuple[Knots, ...]
    coefficients: Annotated[Any, BeforeValidator(_nested)]

    @field_validator("knots")
    @classmethod
    def _one_list_per_coordinate(cls, knots: tuple, info: ValidationInfo) -> tuple:
        if "coordinates" in info.data and len(knots) != len(info.data["coordinates"]):
            raise ValueError(f"found {len(knots)} lists of knots, expected {len(info.data['coordinates'])}")
        return knots

    @field_validator("coefficients")
    @classmethod
    def _fits_knots(cls, coefficients: tuple, info: ValidationInfo) -> tuple:
        if "knots" in info.data and "coordinates" in info.data:
            table = np.array(coefficients)
            if table.ndim != len(info.data["coordinates"]):
                raise ValueError(f"found {table.ndim} levels of lists, expected {len(info.data['coordinates'])}")
            for axis, (name, knots) in enumerate(zip(info.data["coordinates"], info.data["knots"], strict=True)):
                try:
                    _require_spline(knots, np.moveaxis(table, axis, 0))
                except ValueError as error:
                    raise ValueError(f"{name}: {error}") from error
        return coefficients

    @property
    def splines(self) -> tuple[Spline, ...]:
        """The functions B of each coordinate: the value of a spline at an angle is the array of all functions."""
        counts = np.shape(self.coefficients)
        return tuple(
            Spline(np.array(knots), np.eye(count), len(knots) - count - 1)
            for knots, count in zip(self.knots, counts, strict=True)
        )

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """From the first to the last knot (rad) of each coordinate. Outside, the term is linear."""
        return tuple(_range(*each) for each in zip(self.knots, np.shape(self.coefficients), strict=True))


def _kind(value: Any) -> str:
    several = "coordinates" in value if isinstance(value, dict) else isinstance(value, TensorTerm)
    return "tensor" if several else "one"


AnyTerm = Annotated[Annotated[PathTerm, Tag("one")] | Annotated[TensorTerm, Tag("tensor")], Discriminator(_kind)]


def _range(knots: tuple[float, ...], count: int) -> tuple[float, float]:
    degree = len(knots) - count - 1
    return knots[degree], knots[-degree - 1]


def _require_spline(knots: tuple[float, ...], coefficients: np.ndarray) -> None:
    """Raises ValueError unless the knots fit the coefficients along their first axis and moment arms are sensible."""
    count = len(coefficients)
    degree = len(knots) - count - 1
    counts = f"{len(knots)} knots for {count} coefficients"
    if count < 2:
        raise ValueError("expected at least 2 coefficients")
    if degree < 1:
        raise ValueError(f"found {counts}, expected at least {count + 2} knots")
    if degree > _HIGHEST_DEGREE:
        most = count + _HIGHEST_DEGREE + 1
        raise ValueError(f"found {counts}, expected at most {most}: a spline of degree {_HIGHEST_DEGREE}")
    gaps = np.diff(knots)
    if np.any(gaps < 0) or not knots[degree] < knots[-degree - 1]:
        raise ValueError("expected knots in ascending order")
    if np.any((gaps > 0) & (gaps < _CLOSEST_KNOTS)):
        raise ValueError(f"expected knots that are equal or at least {_CLOSEST_KNOTS:g} rad apart")
    spans = np.subtract(knots[degree + 1 : -1], knots[1 : -degree - 1])  # rad, one per coefficient of the slope
    if not spans.all():
        raise ValueError(f"expected knots that are given at most {degree} times, or {degree + 1} times at an end")
    slopes = degree * np.diff(coefficients, axis=0) / spans.reshape(-1, *[1] * (coefficients.ndim - 1))
    steepest = np.abs(slopes).max()
    if steepest > _LARGEST_MOMENT_ARM:
        raise ValueError(f"found moment arms of up to {steepest:.3g} m, expected at most {_LARGEST_MOMENT_ARM:g} m")
