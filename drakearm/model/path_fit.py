"""Fits path functions to sampled musculotendon lengths and moment arms, as of a model with wrapping.

The length of a muscle becomes a sum of B-splines: one per coordinate where that is enough, else tensor-product
B-splines of two or three coordinates. Wrapping that changes sides makes lengths jump. The fit then follows the moment
arms and most of the lengths, so that the fitted path is smooth, and the jumps are reported.
"""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from drakearm.errors import PathError
from drakearm.model.path_samples import Jump, PathSampler, find_components, find_jumps, sample_grid
from drakearm.model.spline_fit import Grid, Limits, basis, fit_on_grid

_TYPICAL = 0.05  # m: the largest moment arm of a limb for which the lengths below are meant
_TOLERANCE = 2e-5  # m, of moment arms
_COUPLING = 1e-5  # m: of a moment arm by another coordinate, below which it is ignored
_SAMPLES = {1: 257, 2: 65, 3: 21}  # per coordinate, by the number of coordinates
_LIMITS = {1: Limits(67, 1 / 64), 2: Limits(256, 1 / 32), 3: Limits(1000, 1 / 8)}
_LOOKS = 50  # postures, to find the largest moment arm
_CHECKS = 500  # postures
_NEAR = 25  # of them, those that set the level of a length that jumps


class FittedTerm(NamedTuple):
    """A part of a length (m): a B-spline of the coordinates (rad), which continues linearly outside its knots."""

    coordinates: tuple[str, ...]
    knots: tuple[np.ndarray, ...]
    coefficients: np.ndarray  # the first index belongs to the first coordinate

    def fields(self) -> dict[str, Any]:
        """The term as `path` in a muscles.yaml has it, with knots to 1e-8 rad and coefficients of 9 digits."""
        knots = [np.round(knots, 8).tolist() for knots in self.knots]
        digits = 8 - math.floor(math.log10(np.abs(self.coefficients).max() or 1.0))
        coefficients = np.round(self.coefficients, digits).tolist()
        if len(knots) == 1:
            return {"coordinate": self.coordinates[0], "knots": knots[0], "coefficients": coefficients}
        return {"coordinates": list(self.coordinates), "knots": knots, "coefficients": coefficients}

    def evaluate(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values (m,) and slopes (m, coordinates) at angles q (m, coordinates) within the knots."""
        return self._contract(q), np.stack([self._contract(q, j) for j in range(q.shape[1])], axis=1)

    def _contract(self, q: np.ndarray, slope_of: int | None = None) -> np.ndarray:
        result = np.broadcast_to(self.coefficients, (len(q), *self.coefficients.shape))
        for j, knots in enumerate(self.knots):
            rows = basis(q[:, j], knots, int(j == slope_of)).toarray()
            result = np.einsum("mi,mi...->m...", rows, result)
        return result


class Error(NamedTuple):
    """Of a fit, in m, at random postures of the whole range."""

    largest: float
    median: float

    def scaled(self, factor: float) -> "Error":
        return Error(factor * self.largest, factor * self.median)


@dataclass(frozen=True)
class PathFit:
    """The fitted path of one muscle."""

    muscle: str
    terms: tuple[FittedTerm, ...]  # none if no coordinate moves the muscle
    length_error: Error
    moment_arm_error: dict[str, Error]  # of the coordinates that move the muscle
    jumps: tuple[Jump, ...]

    def scaled(self, factor: float) -> "PathFit":
        """The fit of a limb that is larger by a factor."""
        return PathFit(
            self.muscle,
            tuple(term._replace(coefficients=factor * term.coefficients) for term in self.terms),
            self.length_error.scaled(factor),
            {name: error.scaled(factor) for name, error in self.moment_arm_error.items()},
            tuple(jump._replace(size=factor * jump.size) for jump in self.jumps),
        )


def fit_paths(
    sample: PathSampler,
    muscles: Sequence[str],
    coordinates: Sequence[str],
    lower: np.ndarray,
    upper: np.ndarray,
    reference: np.ndarray | None = None,
    search: int = 1,
) -> list[PathFit]:
    """Fits the paths of muscles within lower..upper (rad) of each coordinate, and measures the errors.

    sample: lengths and moment arms at many postures, see `PathSampler`; `with_differences` makes one from lengths.
    Samples may be NaN where a path cannot be computed. The same samples give the same fit.
    reference: the posture (rad) near which lengths that jump elsewhere are right; by default the middle of the range.
    search: how many times as many samples as for the fit are searched for jumps, along single coordinates.

    A leg of an insect is fitted like that of a person: the tolerances are fractions of the largest moment arm. The fit
    is less accurate where it would need too many coefficients.

    Raises PathError for a length that is not a sum of functions of at most three coordinates, or is never a number.
    """
    arms = sample(np.random.default_rng(2).uniform(lower, upper, (_LOOKS, len(lower))))[1]
    scale = _TYPICAL / (np.median(np.nan_to_num(np.abs(arms)), axis=0).max() or _TYPICAL)

    def scaled(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        length, arms = sample(q)
        return scale * length, scale * arms

    fits = _fit_typical(scaled, muscles, coordinates, lower, upper, reference, search)
    return [fit.scaled(1.0 / scale) for fit in fits]


def _fit_typical(
    sample: PathSampler,
    muscles: Sequence[str],
    coordinates: Sequence[str],
    lower: np.ndarray,
    upper: np.ndarray,
    reference: np.ndarray | None,
    search: int,
) -> list[PathFit]:
    center = 0.5 * (lower + upper)
    groups = find_components(sample, lower, upper, _COUPLING)
    members = defaultdict(list)  # group of coordinates -> muscles
    for i, (muscle, crossed) in enumerate(zip(muscles, groups, strict=True)):
        for group in crossed:
            if len(group) > max(_LIMITS):
                raise PathError(
                    f"The length of {muscle} depends on {', '.join(coordinates[j] for j in group)} together: "
                    f"expected at most {max(_LIMITS)} coordinates together."
                )
            members[group].append(i)
    terms: list[list[FittedTerm]] = [[] for _ in muscles]
    jumps: list[list[Jump]] = [[] for _ in muscles]
    start = np.nan_to_num(sample(center[None])[0][0])
    for group, crossing in sorted(members.items()):
        every = search if len(group) == 1 else 1
        axes = [np.linspace(lower[j], upper[j], (_SAMPLES[len(group)] - 1) * every + 1) for j in group]
        grid = sample_grid(sample, center, group, axes)
        for i in crossing:
            if not np.isfinite(grid.slopes[:, i]).any():
                raise PathError(f"The moment arms of {muscles[i]} are not numbers while other joints are mid-range.")
            jumps[i] += find_jumps(sample, center, group, grid, i)
        names = tuple(coordinates[j] for j in group)
        for chosen in [crossing] if len(group) == 1 else [[i] for i in crossing]:
            values, slopes = grid.values[::every, chosen] - start[chosen], grid.slopes[::every, chosen]
            own = Grid([axis[::every] for axis in axes], values, slopes)
            robust = np.array([any(jump.coordinate in group for jump in jumps[i]) for i in chosen])
            knots, coefficients = fit_on_grid(own, robust, _TOLERANCE, _LIMITS[len(group)])
            for k, i in enumerate(chosen):
                terms[i].append(FittedTerm(names, tuple(knots), coefficients[..., k]))
    q = np.random.default_rng(1).uniform(lower, upper, (_CHECKS, len(lower)))
    away = ((q - (center if reference is None else reference)) / (upper - lower)) ** 2
    q = q[np.argsort(away.sum(axis=1), kind="stable")]
    return _checked(q, *sample(q), muscles, coordinates, terms, jumps)


def _checked(
    q: np.ndarray,
    length: np.ndarray,
    arms: np.ndarray,
    muscles: Sequence[str],
    coordinates: Sequence[str],
    terms: list[list[FittedTerm]],
    jumps: list[list[Jump]],
) -> list[PathFit]:
    """The fits, with their errors at postures q, and at the right level there: if a length jumps, at the first."""
    fits = []
    for i, muscle in enumerate(muscles):
        if not np.isfinite(length[:, i]).any():
            raise PathError(f"The length of {muscle} is not a number in any of {len(q)} postures.")
        fitted, slopes = np.zeros(len(q)), np.zeros(q.shape)
        for term in terms[i]:
            group = [list(coordinates).index(name) for name in term.coordinates]
            value, slope = term.evaluate(q[:, group])
            fitted += value
            slopes[:, group] += slope
        levels = [x for x in length[:, i] - fitted if np.isfinite(x)]
        level = np.median(levels[:_NEAR] if jumps[i] else levels)
        if terms[i]:
            terms[i][0] = terms[i][0]._replace(coefficients=terms[i][0].coefficients + level)
        moving = {name for term in terms[i] for name in term.coordinates}
        arm_errors = {
            name: _error(arms[:, i, j] + slopes[:, j]) for j, name in enumerate(coordinates) if name in moving
        }
        error = _error(length[:, i] - fitted - level)
        fits.append(PathFit(muscle, tuple(terms[i]), error, arm_errors, tuple(jumps[i])))
    return fits


def _error(difference: np.ndarray) -> Error:
    return Error(float(np.nanmax(np.abs(difference))), float(np.nanmedian(np.abs(difference))))
