"""An arm and its muscles as frozen dataclasses, which check every number when they are created.

The limits of the numbers are wide: limbs of insects and of elephants are inside. Beyond them there are no muscles, and
the equations overflow or need shorter time steps than any simulation has.
"""

from collections import Counter
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, ValidationInfo, field_validator, model_validator
from pydantic.dataclasses import dataclass
from scipy.interpolate import BSpline

from drakearm.files.fields import STRICT, Fraction, Number, Positive
from drakearm.model.paths import make_path_table
from drakearm.muscle.models import MODEL_CODES, MODELS
from drakearm.muscle.parameters import MUSCLE_DTYPE

_DENSITY = 1059.7  # kg/m^3, of muscle (Mendez and Keys 1960)
_STEEPEST = np.arccos(0.1)  # pennation at the minimum fiber length, as in OpenSim
_SHORTEST = 1e-3  # times optimal fiber length: least length of an unpennated fiber, which would have no direction at 0
_LEAST_STRETCH = 1e-4  # optimal fiber lengths, of a compliant tendon at max_isometric_force
_CLOSEST_KNOTS = 1e-6  # rad
_LARGEST_MOMENT_ARM = 100.0  # m, as bounded by the coefficients of the spline, which can be far above the true one
_HIGHEST_DEGREE = 12  # of a path's spline: higher polynomials are not computed accurately


def _within(low: float, high: float, unit: str = "") -> AfterValidator:
    """Refuses numbers outside of [low, high], the range of all muscles that there are, and more."""

    def check(value: float) -> float:
        if not low <= value <= high:
            raise ValueError(f"expected {low:g} to {high:g}{unit}, as all animals have")
        return value

    return AfterValidator(check)


def _name(value: str) -> str:
    if not value.isprintable() or value != value.strip():
        raise ValueError("expected a name without control characters and without spaces around it")
    return value


def _each_once(names: tuple[str, ...]) -> tuple[str, ...]:
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


@dataclass(frozen=True, config=STRICT)
class PathTerm:
    """The part of a musculotendon length (m) that depends on one coordinate (rad).

    It is a B-spline, which continues linearly outside its knots.
    """

    coordinate: Name
    knots: Annotated[tuple[Angle, ...], Field(max_length=1000)]
    coefficients: Annotated[tuple[Length, ...], Field(max_length=1000)]

    @field_validator("coefficients")
    @classmethod
    def _fits_knots(cls, coefficients: tuple, info: ValidationInfo) -> tuple:
        if "knots" not in info.data:  # they have a problem of their own
            return coefficients
        knots = info.data["knots"]
        degree = len(knots) - len(coefficients) - 1
        counts = f"{len(knots)} knots for {len(coefficients)} coefficients"
        if len(coefficients) < 2:
            raise ValueError("expected at least 2 coefficients")
        if degree < 1:
            raise ValueError(f"found {counts}, expected at least {len(coefficients) + 2} knots")
        if degree > _HIGHEST_DEGREE:
            most = len(coefficients) + _HIGHEST_DEGREE + 1
            raise ValueError(f"found {counts}, expected at most {most}: a spline of degree {_HIGHEST_DEGREE}")
        gaps = np.diff(knots)
        if np.any(gaps < 0) or not knots[degree] < knots[-degree - 1]:
            raise ValueError("expected knots in ascending order")
        if np.any((gaps > 0) & (gaps < _CLOSEST_KNOTS)):
            raise ValueError(f"expected knots that are equal or at least {_CLOSEST_KNOTS:g} rad apart")
        spans = np.subtract(knots[degree + 1 : -1], knots[1 : -degree - 1])  # rad, one per coefficient of the slope
        if not spans.all():
            raise ValueError(f"expected knots that are given at most {degree} times, or {degree + 1} times at an end")
        steepest = np.abs(degree * np.diff(coefficients) / spans).max()
        if steepest > _LARGEST_MOMENT_ARM:
            raise ValueError(f"found moment arms of up to {steepest:.3g} m, expected at most {_LARGEST_MOMENT_ARM:g} m")
        return coefficients

    @property
    def spline(self) -> BSpline:
        degree = len(self.knots) - len(self.coefficients) - 1
        return BSpline(np.array(self.knots), np.array(self.coefficients), degree)


@dataclass(frozen=True, config=STRICT)
class Muscle:
    """A Hill-type muscle. Units: m, N, s, rad, Pa; strains, shapes and fractions have no unit.

    model: thelen2003, or degroote2016, which is smooth everywhere. tendon: compliant or rigid. With a rigid tendon the
    joint angles alone determine the fiber length. Both models use passive_shape, passive_strain and tendon_strain. Only
    thelen2003 uses active_width, force_velocity_shape and eccentric_force.
    """

    name: Name
    max_isometric_force: Annotated[Positive, _within(1e-6, 1e6, " N")]
    optimal_fiber_length: Annotated[Positive, _within(1e-5, 10.0, " m")]
    tendon_slack_length: Annotated[Positive, _within(1e-6, 10.0, " m")]
    pennation_angle: Annotated[Number, Field(ge=0, lt=1.4)]  # at the optimal fiber length
    path: tuple[PathTerm, ...]
    points: Annotated[tuple[Point, ...], Field(max_length=1000)]  # for drawing only
    max_contraction_velocity: Annotated[Positive, _within(0.1, 100.0)]  # optimal fiber lengths per second
    activation_time: Annotated[Positive, _within(1e-3, 10.0, " s")]
    deactivation_time: Annotated[Positive, _within(1e-3, 10.0, " s")]
    minimum_activation: Annotated[Number, Field(gt=0, lt=1), _within(1e-4, 0.99)]
    tendon_strain: Annotated[Positive, _within(1e-3, 1.0)]  # at max_isometric_force
    passive_strain: Annotated[Positive, _within(0.05, 10.0)]  # at max_isometric_force
    passive_shape: Annotated[Positive, _within(0.1, 20.0)]
    active_width: Annotated[Positive, _within(0.05, 10.0)]
    force_velocity_shape: Annotated[Positive, _within(0.01, 10.0)]
    eccentric_force: Annotated[Number, Field(gt=1), _within(1.1, 10.0)]  # over isometric force
    specific_tension: Annotated[Positive, _within(1e3, 1e8, " Pa")]  # determines the muscle's mass
    slow_twitch_fraction: Fraction  # of the fibers, for the metabolic power
    model: str = "thelen2003"  # one of `drakearm.muscle.models.MODELS`
    tendon: Literal["compliant", "rigid"] = "compliant"

    @field_validator("path")
    @classmethod
    def _one_term_per_coordinate(cls, path: tuple[PathTerm, ...]) -> tuple[PathTerm, ...]:
        _each_once(tuple(term.coordinate for term in path))
        return path

    @field_validator("model")
    @classmethod
    def _known(cls, model: str) -> str:
        if model not in MODELS:
            raise ValueError(f"expected one of {', '.join(MODELS)}")
        return model

    @model_validator(mode="after")
    def _tendon_stretches(self) -> Self:
        """A stiffer tendon would need shorter time steps, and would move its fiber by less than any experiment sees."""
        stretch = self.tendon_strain * self.tendon_slack_length
        least = _LEAST_STRETCH * self.optimal_fiber_length
        if not self.rigid_tendon and stretch < least:
            raise ValueError(
                f"found a tendon that stretches by {stretch:.2g} m (tendon_strain times tendon_slack_length), expected "
                f"at least {least:.2g} m ({_LEAST_STRETCH:g} of optimal_fiber_length), or tendon: rigid"
            )
        return self

    @property
    def model_code(self) -> int:
        """The number of the model in the compiled functions."""
        return MODEL_CODES[self.model]

    @property
    def rigid_tendon(self) -> bool:
        return self.tendon == "rigid"

    @property
    def mass(self) -> float:
        """Mass (kg) of the fibers: density * cross section * length, with cross section = force / specific tension."""
        return _DENSITY * self.max_isometric_force / self.specific_tension * self.optimal_fiber_length

    @property
    def fiber_width(self) -> float:
        """Thickness (m) of the fibers, the same at every length: optimal fiber length * sin(pennation angle)."""
        return self.optimal_fiber_length * np.sin(self.pennation_angle)

    @property
    def minimum_fiber_length(self) -> float:
        """Fiber length (m) at which the pennation angle reaches acos(0.1), but at least 0.001 optimal_fiber_length."""
        return max(self.fiber_width / np.sin(_STEEPEST), _SHORTEST * self.optimal_fiber_length)

    @property
    def passive_offset(self) -> float:
        """The passive force over max_isometric_force is passive_scale * (exp(...) - passive_offset)."""
        return self._passive_constants[0]

    @property
    def passive_scale(self) -> float:
        """See `passive_offset`."""
        return self._passive_constants[1]

    @property
    def _passive_constants(self) -> tuple[float, float]:
        return MODELS[self.model].passive_constants(self.passive_strain, self.passive_shape)


@dataclass(frozen=True, config=STRICT)
class Capsule:
    """A part of the arm's outline: all points within a radius of the straight line between two ends. Units: m."""

    name: Name
    radius: Annotated[Positive, Field(le=100.0)]
    ends: tuple[Point, Point]


@dataclass(frozen=True, config=STRICT)
class Arm:
    """An arm: a skeleton file for Drake's Parser and the muscles on it. `load_arm` reads one from a folder."""

    name: Name
    skeleton: Path  # absolute
    gravity: tuple[Acceleration, Acceleration, Acceleration]  # in the world
    # Joints of the skeleton. The compiled equations of motion of a chain have about 5 times more terms per joint.
    coordinates: Annotated[tuple[Name, ...], Field(max_length=7), AfterValidator(_each_once)]
    load_frame: Name  # frame of the skeleton where loads hang
    tip_frame: Name  # frame of the skeleton whose path is planned and drawn
    muscles: Annotated[tuple[Muscle, ...], Field(max_length=1000)]
    # The arm's surface, which plans keep away from obstacles.
    outline: Annotated[tuple[Capsule, ...], Field(max_length=1000)] = ()

    @field_validator("muscles")
    @classmethod
    def _consistent(cls, muscles: tuple[Muscle, ...], info: ValidationInfo) -> tuple[Muscle, ...]:
        if not muscles:
            raise ValueError("expected at least one muscle")
        for name, count in Counter(muscle.name for muscle in muscles).items():
            if count > 1:
                raise ValueError(f"muscle {name} is given twice: expected every name once")
        if "coordinates" not in info.data:  # they have a problem of their own
            return muscles
        coordinates = info.data["coordinates"]
        for muscle in muscles:
            for term in muscle.path:
                if term.coordinate not in coordinates:
                    raise ValueError(
                        f"the path of {muscle.name} depends on {term.coordinate}: "
                        f"expected one of the coordinates {', '.join(coordinates)}"
                    )
        return muscles

    @property
    def muscle_names(self) -> tuple[str, ...]:
        return tuple(m.name for m in self.muscles)

    @cached_property
    def muscle_table(self) -> np.ndarray:
        """The numbers of the muscles for the compiled functions: an array (n,) of records of `MUSCLE_DTYPE`."""
        rows = [tuple(getattr(m, field) for field in MUSCLE_DTYPE.names or ()) for m in self.muscles]
        return np.array(rows, dtype=MUSCLE_DTYPE)

    @cached_property
    def path_table(self) -> np.ndarray:
        """The path functions of the muscles for the compiled functions, see `make_path_table`."""
        return make_path_table(
            [
                (i, self.coordinates.index(term.coordinate), term.spline)
                for i, muscle in enumerate(self.muscles)
                for term in muscle.path
            ]
        )
