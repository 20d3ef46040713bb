"""Completes an arm whose file leaves out what follows from the rest: paths, and slack lengths of tendons."""

import logging
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from pydantic import ValidationError

from drakearm.errors import ArmError, shown
from drakearm.model.arm import Arm, Muscle
from drakearm.model.musculature import muscle_geometry
from drakearm.model.point_paths import described_posture
from drakearm.model.skeleton import position_ranges, skeleton_plant

if TYPE_CHECKING:
    from drakearm.model.fitted_paths import FittedPath

# Instead of a slack length that `complete` determines, so that the rest of the file can be checked: any allowed number.
SLACK_LENGTH_TO_COME = 1.0
_warned: set[tuple[Path, str]] = set()


class Limb(NamedTuple):
    """An arm, and what `load_limb` has computed of it because its file leaves it out."""

    arm: Arm
    fitted: "dict[str, FittedPath]"  # of muscles: path functions that are fitted to their points
    # Of muscles: the joint angles (n_q,), rad, that determine the slack length of the tendon. There the fiber is
    # optimal while the tendon is just taut.
    optimal_posture: dict[str, np.ndarray]


def complete(arm: Arm, file: Path, without_slack_length: Collection[str]) -> Limb:
    """The arm with a path for each muscle, and a slack length for the tendons of some muscles.

    file: the muscles.yaml, for errors. without_slack_length: names of muscles. Raises ArmError as `fit_points` does,
    and where there is no room for a tendon.
    """
    without_path = tuple(muscle for muscle in arm.muscles if not muscle.path)
    if not without_path:
        return Limb(arm, {}, {})
    from drakearm.model.fitted_paths import fit_points  # with parts of SciPy that take 0.3 s to import

    plant = skeleton_plant(arm)
    fits = fit_points(plant, arm, without_path, file)
    fitted = {muscle.name: fit for muscle, fit in zip(without_path, fits, strict=True)}
    for name, fit in fitted.items():
        _warn_of_misfit(file, name, fit)
    muscles = tuple(replace(m, path=fitted[m.name].path) if m.name in fitted else m for m in arm.muscles)
    arm = replace(arm, muscles=muscles)
    q = np.deg2rad(arm.optimal_posture_deg) if arm.optimal_posture_deg else np.mean(position_ranges(plant), axis=0)
    lengths, _ = muscle_geometry(q, arm.muscle_table, arm.path_table)
    muscles = tuple(
        _with_slack_length(arm, m, float(length), q, file) if m.name in without_slack_length else m
        for m, length in zip(arm.muscles, lengths, strict=True)
    )
    return Limb(replace(arm, muscles=muscles), fitted, dict.fromkeys(without_slack_length, q))


def _with_slack_length(arm: Arm, muscle: Muscle, path: float, q: np.ndarray, file: Path) -> Muscle:
    """path: the length (m) at q (n_q,), rad."""
    fiber = muscle.optimal_fiber_length * np.cos(muscle.pennation_angle)
    try:
        return replace(muscle, tendon_slack_length=path - fiber)
    except ValidationError as error:
        raise ArmError(
            f"{shown(file)}: muscles.{muscle.name}: at {described_posture(arm.coordinates, q)} its path is "
            f"{1e3 * path:.4g} mm long, and its optimal fiber takes {1e3 * fiber:.4g} mm of it: expected a shorter "
            "fiber, so that there is room for a tendon."
        ) from error


def _warn_of_misfit(file: Path, muscle: str, fit: "FittedPath") -> None:
    """Once per process, because an arm is loaded many times."""
    if not fit.is_good and (file, muscle) not in _warned:
        _warned.add((file, muscle))
        logging.getLogger("drakearm").warning(
            "The path of %s misses its points by up to %.2g mm in length and %.2g mm in moment arm, which is at most "
            "%.2g mm: `drakearm inspect` shows where it changes abruptly.",
            muscle,
            1e3 * fit.length_error,
            1e3 * fit.moment_arm_error,
            1e3 * fit.largest_moment_arm,
        )
