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

from drakearm.errors import did_you_mean, shown
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Degrees, Fraction, Number, Positive
from drakearm.model.fields import Acceleration, Name, Point, each_once
from drakearm.model.path_terms import AnyTerm, TensorTerm
from drakearm.model.paths import make_path_table
from drakearm.model.surface import Surface
from drakearm.muscle.models import MODEL_CODES, MODELS
from drakearm.muscle.parameters import MUSCLE_DTYPE

_DENSITY = 1059.7  # kg/m^3, of muscle (Mendez and Keys 1960)
_STEEPEST = np.arccos(0.1)  # pennation at the minimum fiber length, as in OpenSim
_SHORTEST = 1e-3  # times optimal fiber length: least length of an unpennated fiber, which would have no direction at 0
_LEAST_STRETCH = 1e-4  # optimal fiber lengths, of a compliant tendon at max_isometric_force


def _within(low: float, high: float, unit: str = "") -> AfterValidator:
    """Refuses numbers outside of [low, high], the range of all muscles that there are, and more."""

    def check(value: float) -> float:
        if not low <= value <= high:
            raise ValueError(f"expected {low:g} to {high:g}{unit}, as all animals have")
        return value

    return AfterValidator(check)


@checked_dataclass()
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
    pennation_angle: Annotated[Number, _within(0.0, 1.4, " rad")]  # at the optimal fiber length
    # Attachments and via points. They are for drawing, and `load_arm` makes the path from them if the file has none.
    points: Annotated[tuple[Point, ...], Field(max_length=1000)]
    # The arm's surface between each point and the next one, or None: as many as points but one, or none at all.
    wraps: Annotated[tuple[Name | None, ...], Field(max_length=1000)] = ()
    path: tuple[AnyTerm, ...] = ()  # the musculotendon length is the sum of these
    # The curves of young adults of Thelen, "Adjustment of muscle mechanics model parameters to simulate dynamic
    # contractions in older adults", Journal of Biomechanical Engineering 125:70-77, 2003. They are the defaults of
    # OpenSim 4's Thelen2003Muscle too.
    max_contraction_velocity: Annotated[Positive, _within(0.1, 100.0)] = 10.0  # optimal fiber lengths per second
    minimum_activation: Annotated[Number, Field(gt=0, lt=1), _within(1e-4, 0.99)] = 0.01
    tendon_strain: Annotated[Positive, _within(1e-3, 1.0)] = 0.04  # at max_isometric_force
    passive_strain: Annotated[Positive, _within(0.05, 10.0)] = 0.6  # at max_isometric_force
    passive_shape: Annotated[Positive, _within(0.1, 20.0)] = 5.0
    active_width: Annotated[Positive, _within(0.05, 10.0)] = 0.45
    force_velocity_shape: Annotated[Positive, _within(0.01, 10.0)] = 0.25
    eccentric_force: Annotated[Number, Field(gt=1), _within(1.1, 10.0)] = 1.4  # over isometric force
    # Millard, Uchida, Seth, Delp, "Flexing computational muscle: modeling and simulation of musculotendon dynamics",
    # Journal of Biomechanical Engineering 135:021005, 2013.
    activation_time: Annotated[Positive, _within(1e-3, 10.0, " s")] = 0.01
    deactivation_time: Annotated[Positive, _within(1e-3, 10.0, " s")] = 0.04
    # OpenSim's Bhargava2004MuscleMetabolicsProbe.
    specific_tension: Annotated[Positive, _within(1e3, 1e8, " Pa")] = 0.25e6  # determines the muscle's mass
    slow_twitch_fraction: Fraction = 0.5  # of the fibers, for the metabolic power
    model: str = "thelen2003"  # one of `drakearm.muscle.models.MODELS`
    tendon: Literal["compliant", "rigid"] = "compliant"

    @field_validator("wraps")
    @classmethod
    def _one_for_each_pair(cls, wraps: tuple[str | None, ...], info: ValidationInfo) -> tuple[str | None, ...]:
        pairs = len(info.data.get("points", ())) - 1
        if pairs > 0 and wraps and len(wraps) != pairs:
            raise ValueError(
                f"found {len(wraps)}, expected {pairs}: for each point but the last the surface between it and the "
                "next point, or null"
            )
        return wraps

    @field_validator("path")
    @classmethod
    def _one_term_per_coordinates(cls, path: tuple[AnyTerm, ...]) -> tuple[AnyTerm, ...]:
        each_once(tuple(" with ".join(sorted(term.coordinates)) for term in path))
        return path

    @field_validator("model")
    @classmethod
    def _known(cls, model: str) -> str:
        if model not in MODELS:
            raise ValueError(f"expected one of {', '.join(MODELS)}")
        return model

    @model_validator(mode="after")
    def _has_a_path(self) -> Self:
        if not self.path and len(self.points) < 2:
            raise ValueError(f"points: found {len(self.points)}, expected at least 2, or a path")
        return self

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


@checked_dataclass()
class Capsule:
    """A part of the arm's outline: all points within a radius of the straight line between two ends. Units: m."""

    name: Name
    radius: Annotated[Positive, Field(le=100.0)]
    ends: tuple[Point, Point]


@checked_dataclass()
class Arm:
    """An arm: a skeleton file for Drake's Parser and the muscles on it. `load_arm` reads one from a folder."""

    name: Name
    skeleton: Path  # absolute
    # Joints of the skeleton. The compiled equations of motion have about 5 times more terms per joint of a chain.
    coordinates: Annotated[tuple[Name, ...], Field(max_length=7), AfterValidator(each_once)]
    tip_frame: Name  # frame of the skeleton whose path is planned and drawn
    muscles: Annotated[tuple[Muscle, ...], Field(max_length=1000)]
    load_frame: Name | None = None  # frame of the skeleton where loads hang; None: the tip
    gravity: tuple[Acceleration, Acceleration, Acceleration] = (0.0, 0.0, -9.81)  # in the world
    surfaces: Annotated[tuple[Surface, ...], Field(max_length=1000)] = ()  # over which muscles wrap
    # Joint angles at which those fibers are optimal whose tendons have no slack length in the file. Empty: the middles
    # of the ranges.
    optimal_posture_deg: tuple[Degrees, ...] = ()
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
                for name in term.coordinates:
                    if name not in coordinates:
                        raise ValueError(
                            f"the path of {muscle.name} depends on {name}: "
                            f"expected one of the coordinates {', '.join(coordinates)}"
                        )
        return muscles

    @field_validator("optimal_posture_deg")
    @classmethod
    def _one_angle_per_coordinate(cls, angles: tuple[float, ...], info: ValidationInfo) -> tuple[float, ...]:
        names = info.data.get("coordinates", ())
        if names and angles and len(angles) != len(names):
            raise ValueError(f"found {len(angles)}, expected {len(names)}: one for each of {', '.join(names)}")
        return angles

    @field_validator("surfaces")
    @classmethod
    def _different(cls, surfaces: tuple[Surface, ...]) -> tuple[Surface, ...]:
        if surfaces:
            each_once(tuple(surface.name for surface in surfaces))
        return surfaces

    @model_validator(mode="after")
    def _has_the_surfaces(self) -> Self:
        known = [surface.name for surface in self.surfaces]
        for muscle in self.muscles:
            for name in muscle.wraps:
                if name is not None and name not in known:
                    raise ValueError(
                        f"muscles.{muscle.name}.wraps: found {shown(name)}{did_you_mean(name, known)}, expected a name "
                        f"in surfaces: {', '.join(known) or 'there is none'}"
                    )
        return self

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
        one, several = [], []
        for i, muscle in enumerate(self.muscles):
            for term in muscle.path:
                at = [self.coordinates.index(name) for name in term.coordinates]
                if isinstance(term, TensorTerm):
                    several.append((i, at, term.splines, np.array(term.coefficients)))
                else:
                    one.append((i, at[0], term.spline))
        return make_path_table(one, several)
