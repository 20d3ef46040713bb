"""An arm and its muscles as frozen dataclasses, which check every number when they are created."""

from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, ValidationInfo, field_validator
from pydantic.dataclasses import dataclass
from scipy.interpolate import BSpline

from drakearm.files.fields import STRICT, Finite, Positive
from drakearm.model.paths import make_path_table
from drakearm.muscle.models import MODEL_CODES, MODELS
from drakearm.muscle.parameters import MUSCLE_DTYPE

Fraction = Annotated[float, Field(gt=0, lt=1)]
Name = Annotated[str, Field(min_length=1)]

_DENSITY = 1059.7  # kg/m^3, of muscle (Mendez and Keys 1960)
_STEEPEST = np.arccos(0.1)  # pennation at the minimum fiber length, as in OpenSim


@dataclass(frozen=True, config=STRICT)
class PathTerm:
    """The part of a musculotendon length (m) that depends on one coordinate (rad).

    It is a B-spline, which continues linearly outside its knots.
    """

    coordinate: Name
    knots: tuple[Finite, ...]
    coefficients: Annotated[tuple[Finite, ...], Field(min_length=2)]

    @field_validator("coefficients")
    @classmethod
    def _fits_knots(cls, coefficients: tuple, info: ValidationInfo) -> tuple:
        knots = info.data.get("knots", ())
        degree = len(knots) - len(coefficients) - 1
        if degree < 1:
            needed = len(coefficients) + 2
            raise ValueError(f"expected at least {needed} knots for {len(coefficients)} coefficients, not {len(knots)}")
        if np.any(np.diff(knots) < 0) or not knots[degree] < knots[-degree - 1]:
            raise ValueError("expected knots in ascending order")
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
    max_isometric_force: Positive
    optimal_fiber_length: Positive
    tendon_slack_length: Positive
    pennation_angle: Annotated[float, Field(ge=0, lt=1.4)]  # at the optimal fiber length
    path: Annotated[tuple[PathTerm, ...], Field(min_length=1)]
    points: tuple[tuple[Name, tuple[Finite, Finite, Finite]], ...]  # (body, position in it), for drawing only
    max_contraction_velocity: Positive  # optimal fiber lengths per second
    activation_time: Positive
    deactivation_time: Positive
    minimum_activation: Fraction
    tendon_strain: Positive  # at max_isometric_force
    passive_strain: Positive  # at max_isometric_force
    passive_shape: Positive
    active_width: Positive
    force_velocity_shape: Positive
    eccentric_force: Annotated[float, Field(gt=1, allow_inf_nan=False)]  # over isometric force
    specific_tension: Positive  # Pa, determines the muscle's mass
    slow_twitch_fraction: Annotated[float, Field(ge=0, le=1)]  # of the fibers, for the metabolic power
    model: str = "thelen2003"  # one of `drakearm.muscle.models.MODELS`
    tendon: Literal["compliant", "rigid"] = "compliant"

    @field_validator("model")
    @classmethod
    def _known(cls, model: str) -> str:
        if model not in MODELS:
            raise ValueError(f"expected one of {', '.join(MODELS)}")
        return model

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
        """Fiber length (m) at which the pennation angle reaches acos(0.1); 0 for an unpennated muscle."""
        return self.fiber_width / np.sin(_STEEPEST)

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
    radius: Positive
    ends: tuple[tuple[Name, tuple[Finite, Finite, Finite]], tuple[Name, tuple[Finite, Finite, Finite]]]  # (body, p)


@dataclass(frozen=True, config=STRICT)
class Arm:
    """An arm: a skeleton file for Drake's Parser and the muscles on it. `load_arm` reads one from a folder."""

    name: Name
    skeleton: Path  # absolute
    gravity: tuple[Finite, Finite, Finite]  # m/s^2, in the world
    coordinates: Annotated[tuple[Name, ...], Field(min_length=1)]  # joints of the skeleton
    load_frame: Name  # frame of the skeleton where loads hang
    tip_frame: Name  # frame of the skeleton whose path is planned and drawn
    muscles: Annotated[tuple[Muscle, ...], Field(min_length=1)]
    outline: tuple[Capsule, ...] = ()  # the arm's surface, which plans keep away from obstacles

    @field_validator("muscles")
    @classmethod
    def _consistent(cls, muscles: tuple[Muscle, ...], info: ValidationInfo) -> tuple[Muscle, ...]:
        names = [m.name for m in muscles]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"muscle {name} is given twice: expected every name once")
        coordinates = info.data.get("coordinates", ())  # missing if they are not valid
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
