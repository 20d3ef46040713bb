"""The numbers by which a biomechanist checks an arm: lengths, moment arms, working ranges and curves of each muscle."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from drakearm.model.arm import Arm, Muscle
from drakearm.model.musculature import RESTING_ACTIVATION, muscle_geometry
from drakearm.model.skeleton import position_ranges, skeleton_plant
from drakearm.muscle import models
from drakearm.muscle.contraction import equilibrium_fiber_length

if TYPE_CHECKING:
    from drakearm.model.fitted_paths import FittedPath

_SAMPLES = 181  # in a range of angles or path lengths
_GRID = 9  # angles of each of the other joints, for a length that is no sum of one function per coordinate
_CURVE_SAMPLES = 121
_PRECISION = 1e-7  # m, of the shortest path


@dataclass(frozen=True)
class Interval:
    """The closed interval [lower, upper]."""

    lower: float
    upper: float


@dataclass(frozen=True)
class Crossing:
    """A muscle over the range of one joint that it crosses. Arrays (k,) have one value for each angle in q.

    shortest, longest: extremes of the musculotendon length over all angles of the other joints. fitted: the angles for
    which the path function was fitted; outside them it continues along its tangents.
    """

    coordinate: str
    q: np.ndarray  # rad
    length: np.ndarray  # m, musculotendon length with the other joints at the arm's neutral angles
    shortest: np.ndarray  # m
    longest: np.ndarray  # m
    moment_arm: np.ndarray  # m, positive where the muscle pulls the angle up
    fitted: Interval  # rad

    @property
    def moment_arm_range(self) -> Interval:
        return _interval(self.moment_arm)


@dataclass(frozen=True)
class WorkingRange:
    """The range of a muscle's equilibria over all joint angles, at rest and at an activation of RESTING_ACTIVATION.

    fiber_length and tendon_strain are None if the muscle has no equilibrium at any joint angles. shortest_path: below
    this musculotendon length (m) there is no equilibrium, because even the shortest fiber leaves the tendon slack.
    slack: the angles (rad) of each coordinate at which this can happen; empty if there is always an equilibrium.
    """

    fiber_length: Interval | None  # over optimal_fiber_length
    tendon_strain: Interval | None
    shortest_path: float
    slack: dict[str, Interval]


@dataclass(frozen=True)
class Curves:
    """A muscle's curves, arrays (k,): forces over max_isometric_force, fiber lengths over optimal_fiber_length."""

    fiber_length: np.ndarray
    active: np.ndarray  # isometric, at full activation
    passive: np.ndarray
    velocity: np.ndarray  # optimal fiber lengths per second, shortening is negative
    force: np.ndarray  # over isometric force, at full activation
    resting_force: np.ndarray  # the same at RESTING_ACTIVATION
    strain: np.ndarray  # of the tendon
    tendon: np.ndarray


@dataclass(frozen=True)
class MuscleInspection:
    muscle: Muscle
    crossings: tuple[Crossing, ...]  # in the order of the arm's coordinates
    working: WorkingRange
    curves: Curves


@dataclass(frozen=True)
class Inspection:
    """All muscles of an arm. neutral: the angles (rad) of the other joints while one joint moves.

    fitted, optimal_posture: as in `drakearm.model.limb.Limb`.
    """

    arm: Arm
    ranges: dict[str, Interval]  # rad, of the joints
    neutral: dict[str, float]
    muscles: tuple[MuscleInspection, ...]
    fitted: "Mapping[str, FittedPath]"
    optimal_posture: Mapping[str, np.ndarray]


def inspect_arm(
    arm: Arm,
    fitted: "Mapping[str, FittedPath]" = MappingProxyType({}),
    optimal_posture: Mapping[str, np.ndarray] = MappingProxyType({}),
) -> Inspection:
    """Inspects every muscle over the joint ranges of the skeleton. `inspect_arm(*load_limb(folder))` knows all.

    The range of a joint without limits is one full turn, [-pi, pi]. The neutral angle of a joint is 0, or the limit
    that is nearest to 0. Raises ArmError if the skeleton does not have the joints or frames that the arm names.
    """
    ranges = joint_ranges(arm)
    neutral = {name: min(max(0.0, r.lower), r.upper) for name, r in ranges.items()}
    crossings = _crossings(arm, ranges, np.array(list(neutral.values())))
    muscles = tuple(
        MuscleInspection(muscle, crossed, _working_range(m, crossed), _curves(m))
        for muscle, m, crossed in zip(arm.muscles, arm.muscle_table, crossings, strict=True)
    )
    return Inspection(arm, ranges, neutral, muscles, fitted, optimal_posture)


def joint_ranges(arm: Arm) -> dict[str, Interval]:
    """The range (rad) of every coordinate, from the skeleton; [-pi, pi] where it has no limits."""
    limits = zip(*position_ranges(skeleton_plant(arm)), strict=True)
    return {name: Interval(*each) for name, each in zip(arm.coordinates, limits, strict=True)}


def _crossings(arm: Arm, ranges: dict[str, Interval], neutral: np.ndarray) -> list[tuple[Crossing, ...]]:
    """The crossings of every muscle."""
    q = np.array([np.linspace(r.lower, r.upper, _SAMPLES) for r in ranges.values()])
    length = np.empty((len(arm.muscles), *q.shape))
    moment_arm = np.empty_like(length)
    for j, k in np.ndindex(q.shape):
        moved = neutral.copy()
        moved[j] = q[j, k]
        length[:, j, k], arms = muscle_geometry(moved, arm.muscle_table, arm.path_table)
        moment_arm[:, j, k] = arms[:, j]
    at_neutral, _ = muscle_geometry(neutral, arm.muscle_table, arm.path_table)
    change = length - at_neutral[:, None, None]
    # Where the length is a sum of one function per coordinate, it is known for all angles if each joint moves alone.
    least, most = change.min(axis=2), change.max(axis=2)
    shortest = length + (least.sum(axis=1, keepdims=True) - least)[:, :, None]
    longest = length + (most.sum(axis=1, keepdims=True) - most)[:, :, None]

    crossings = []
    for i, muscle in enumerate(arm.muscles):
        fitted = _fitted(muscle)
        crossed = [j for j, name in enumerate(arm.coordinates) if name in fitted]
        if any(len(term.coordinates) > 1 for term in muscle.path):
            for j in crossed:
                grid = _grid(arm, i, q, j, [other for other in crossed if other != j], neutral)
                shortest[i, j], longest[i, j] = grid.min(axis=1), grid.max(axis=1)
        crossings.append(
            tuple(
                Crossing(
                    coordinate=arm.coordinates[j],
                    q=q[j],
                    length=length[i, j],
                    shortest=shortest[i, j],
                    longest=longest[i, j],
                    moment_arm=moment_arm[i, j],
                    fitted=fitted[arm.coordinates[j]],
                )
                for j in crossed
            )
        )
    return crossings


def _fitted(muscle: Muscle) -> dict[str, Interval]:
    """The angles (rad) of every coordinate of a muscle inside the knots of all of its terms."""
    fitted: dict[str, Interval] = {}
    for term in muscle.path:
        for name, (lower, upper) in zip(term.coordinates, term.ranges, strict=True):
            before = fitted.get(name, Interval(lower, upper))
            fitted[name] = Interval(max(lower, before.lower), min(upper, before.upper))
    return fitted


def _grid(arm: Arm, muscle: int, q: np.ndarray, j: int, others: list[int], neutral: np.ndarray) -> np.ndarray:
    """The lengths (_SAMPLES, K), m, of a muscle at the angles q[j] of a joint, and on a grid of the other ones."""
    axes = [np.linspace(q[other, 0], q[other, -1], _GRID) for other in others]
    postures = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(others))
    lengths = np.empty((q.shape[1], len(postures)))
    for k, m in np.ndindex(lengths.shape):
        moved = neutral.copy()
        moved[j], moved[others] = q[j, k], postures[m]
        lengths[k, m] = muscle_geometry(moved, arm.muscle_table, arm.path_table)[0][muscle]
    return lengths


def _working_range(m: np.void, crossings: tuple[Crossing, ...]) -> WorkingRange:
    """m: the muscle's record. The equilibrium depends on the joint angles only through the musculotendon length."""
    path = _interval(np.array([crossings[0].shortest, crossings[0].longest]))
    shortest = _shortest_path(m, path)
    slack = {c.coordinate: _interval(c.q[c.shortest < shortest]) for c in crossings if np.any(c.shortest < shortest)}
    if not path.lower <= shortest <= path.upper:
        return WorkingRange(None, None, shortest, slack)
    lengths = np.linspace(shortest, path.upper, _SAMPLES)
    fiber = np.array([equilibrium_fiber_length(RESTING_ACTIVATION, length, m) for length in lengths])
    along = np.sqrt(fiber**2 - m["fiber_width"] ** 2)
    return WorkingRange(
        fiber_length=_interval(fiber / m["optimal_fiber_length"]),
        tendon_strain=_interval((lengths - along) / m["tendon_slack_length"] - 1.0),
        shortest_path=shortest,
        slack=slack,
    )


def _shortest_path(m: np.void, path: Interval) -> float:
    """The smallest musculotendon length in `path` with an equilibrium, by bisection; infinite if there is none."""

    def exists(length: float) -> bool:
        return not np.isnan(equilibrium_fiber_length(RESTING_ACTIVATION, length, m))

    if exists(path.lower):
        return path.lower
    if not exists(path.upper):
        return np.inf
    slack, taut = path.lower, path.upper
    while taut - slack > _PRECISION:
        middle = 0.5 * (slack + taut)
        slack, taut = (slack, middle) if exists(middle) else (middle, taut)
    return taut


def _curves(m: np.void) -> Curves:
    fiber_length = np.linspace(0.0, 1.8, _CURVE_SAMPLES)
    velocity = np.linspace(-1.0, 1.0, _CURVE_SAMPLES)
    strain = np.linspace(0.0, 1.25 * m["tendon_strain"], _CURVE_SAMPLES)
    slowing = models.velocity_scale(RESTING_ACTIVATION, m)[0]
    return Curves(
        fiber_length=fiber_length,
        active=np.array([models.active_force_length(x, m)[0] for x in fiber_length]),
        passive=np.array([models.passive_force_length(x, m)[0] for x in fiber_length]),
        velocity=velocity * m["max_contraction_velocity"],
        force=np.array([models.force_of_velocity(x, m)[0] for x in velocity]),
        resting_force=np.array([models.force_of_velocity(x / slowing, m)[0] for x in velocity]),
        strain=strain,
        tendon=np.array([models.tendon_force_strain(x, m)[0] for x in strain]),
    )


def _interval(values: np.ndarray) -> Interval:
    return Interval(float(values.min()), float(values.max()))
