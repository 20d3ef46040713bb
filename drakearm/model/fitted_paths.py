"""Path functions of muscles that have points and no path: fitted to the lengths of their points, and how well they fit.

A fit takes up to a few seconds, so it is kept in the cache.
"""

from pathlib import Path

import numpy as np
from pydantic import TypeAdapter
from pydrake.multibody.plant import MultibodyPlant

from drakearm.errors import ArmError, PathError, shown
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.model.arm import Arm, Muscle
from drakearm.model.fit_cache import cached
from drakearm.model.path_fit import PathFit, fit_paths
from drakearm.model.path_samples import with_differences
from drakearm.model.path_terms import AnyTerm
from drakearm.model.point_paths import PointPaths
from drakearm.model.skeleton import neutral_posture, position_ranges

_NARROWEST = 0.1  # rad, of the angles for which a path is fitted
_POSTURES = 200  # at which moment arms are measured
_NO_ARM = 1e-9  # m: a smaller moment arm is a rounding error
_TYPICAL = 0.05  # m, a moment arm of a person's limb
_LARGEST_LENGTH_ERROR = 1e-3  # m
_LARGEST_ARM_ERROR = 0.05  # of the largest moment arm


@checked_dataclass()
class FittedPath:
    """The path that was fitted to a muscle's points, and its largest errors over the ranges of the joints."""

    path: tuple[AnyTerm, ...]
    length_error: float  # m
    moment_arm_error: float  # m
    largest_moment_arm: float  # m

    @property
    def moment_arm_share(self) -> float:
        """The largest error of a moment arm over the largest moment arm."""
        return self.moment_arm_error / self.largest_moment_arm

    @property
    def is_good(self) -> bool:
        return self.length_error <= _LARGEST_LENGTH_ERROR and self.moment_arm_share <= _LARGEST_ARM_ERROR


def fit_points(plant: MultibodyPlant, arm: Arm, muscles: tuple[Muscle, ...], file: Path) -> tuple[FittedPath, ...]:
    """Fits the paths of some muscles of an arm to their points, over the ranges of the joints.

    plant: finalized, with the skeleton. file: the muscles.yaml, for errors. Raises ArmError for a point inside a
    surface, for a muscle that no joint moves, and for a length that depends on more than three coordinates together.
    """

    def fit() -> tuple[FittedPath, ...]:
        lower, upper = position_ranges(plant)
        widened = np.maximum(0.0, _NARROWEST - (upper - lower)) / 2.0
        lower, upper = lower - widened, upper + widened
        lengths = PointPaths(plant, arm, muscles, neutral_posture(plant), file)
        q = np.random.default_rng(0).uniform(lower, upper, (_POSTURES, len(lower)))
        largest = np.nanmax(np.abs(with_differences(lengths)(q)[1]), axis=(0, 2))
        for muscle in (m for m, arm_length in zip(muscles, largest, strict=True) if arm_length < _NO_ARM):
            raise ArmError(
                f"{shown(file)}: muscles.{muscle.name}: no joint changes the length of its path: expected points on "
                "both sides of a joint."
            )
        scale = _TYPICAL / largest.max()  # so that the fits are as good for the leg of an insect as for that of a horse
        sample = with_differences(lambda q: scale * lengths(q))
        try:
            fits = fit_paths(sample, [muscle.name for muscle in muscles], arm.coordinates, lower, upper)
        except PathError as error:
            raise ArmError(f"{shown(file)}: {error}") from error
        return tuple(_scaled(each, scale, float(length)) for each, length in zip(fits, largest, strict=True))

    inputs = (arm.coordinates, arm.surfaces, [(m.name, m.points, m.wraps) for m in muscles])
    return cached((arm.skeleton.read_bytes(), inputs), tuple[FittedPath, ...], fit)


def _scaled(fit: PathFit, scale: float, largest_moment_arm: float) -> FittedPath:
    terms = [term._replace(coefficients=term.coefficients / scale) for term in fit.terms]
    return FittedPath(
        path=TypeAdapter(tuple[AnyTerm, ...]).validate_python(tuple(term.fields() for term in terms)),
        length_error=fit.length_error.largest / scale,
        moment_arm_error=max(error.largest for error in fit.moment_arm_error.values()) / scale,
        largest_moment_arm=largest_moment_arm,
    )
