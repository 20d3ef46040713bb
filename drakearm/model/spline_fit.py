"""Least-squares fits of tensor-product B-splines to values and slopes on a grid, with knots where they are needed.

The splines are cubic: their slopes are smooth, and a moment arm is a slope. Knots start evenly spaced. Then intervals
where the slopes fit worst are halved, until all slopes fit or the limit is reached. All columns (the muscles) get the
same knots: compiled paths look only once for the interval of splines of one coordinate that have the same knots.
"""

from collections.abc import Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import solve
from scipy.sparse import csr_array, diags_array, kron, vstack

DEGREE = 3
_FIRST_INTERVALS = 4  # per axis
_SMOOTHNESS = 1e-10  # weight of the penalty that determines the spline where there are no samples
_ROUNDS = 30  # of refinement, at most: each halves at least one interval
_REWEIGHTINGS = 8
_SLOPE_SCALE = 5e-3  # m/rad: slopes with larger residuals count less in columns that have jumps
_VALUE_WEIGHT = 1e-6  # of the values there, which then determine nothing but the level


class Grid(NamedTuple):
    """Samples of n functions on a grid of d axes. NaN is a sample that does not exist."""

    axes: Sequence[np.ndarray]  # rad, ascending
    values: np.ndarray  # (points, n); the last axis varies fastest
    slopes: np.ndarray  # (points, n, d)


class Limits(NamedTuple):
    """How fine knots may become."""

    coefficients: int  # of one function
    smallest: float  # interval, as a fraction of the range of its axis


def clamped(breaks: np.ndarray) -> np.ndarray:
    """Knots of a spline on these intervals: the ends are repeated."""
    return np.concatenate([[breaks[0]] * DEGREE, breaks, [breaks[-1]] * DEGREE])


def basis(x: np.ndarray, knots: np.ndarray, nu: int = 0) -> csr_array:
    """The B-splines (points, coefficients) or, with nu=1, their slopes at x. x: within the knots."""
    if nu == 0:
        return csr_array(BSpline.design_matrix(x, knots, DEGREE))
    inner = csr_array(BSpline.design_matrix(x, knots[1:-1], DEGREE - 1))
    rate = DEGREE / (knots[DEGREE + 1 : -1] - knots[1 : -DEGREE - 1])
    n = len(rate)
    return inner @ diags_array([-rate, rate], offsets=[0, 1], shape=(n, n + 1))


def fit_on_grid(
    grid: Grid, robust: np.ndarray, tolerance: float, limits: Limits
) -> tuple[list[np.ndarray], np.ndarray]:
    """Knots, one array per axis, and coefficients (n_1, ..., n_d, n) of splines close to the samples.

    robust: (n,) whether a column's values have jumps. Its spline follows the slopes, and slopes that disagree with the
    others count little. Its level is that of the mean value.
    tolerance: of the slopes, m/rad.
    """
    breaks = [np.linspace(axis[0], axis[-1], _FIRST_INTERVALS + 1) for axis in grid.axes]
    for _ in range(_ROUNDS):
        knots = [clamped(b) for b in breaks]
        coefficients, misfit = _fit(grid, knots, robust)
        if not _refine(breaks, grid.axes, misfit, tolerance, limits):
            break
    shape = [len(t) - DEGREE - 1 for t in knots]
    return knots, coefficients.reshape(*shape, -1)


def _fit(grid: Grid, knots: list[np.ndarray], robust: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients (n_1 ... n_d, n), and misfits of the slopes (points, d): the largest of all columns."""
    d = len(knots)
    blocks = [_on_grid(grid.axes, knots, slope_of=axis) for axis in (None, *range(d))]
    design = csr_array(vstack(blocks))
    penalty = _roughness(knots)
    target = np.concatenate([grid.values, *np.moveaxis(grid.slopes, 2, 0)])
    exists = np.isfinite(target)
    target = np.where(exists, target, 0.0)
    points, n = grid.values.shape
    coefficients = np.empty((design.shape[1], n))
    weights = exists.astype(float)
    for i in range(n):
        if robust[i]:
            coefficients[:, i], weights[:, i] = _solve_robustly(design, penalty, target[:, i], weights[:, i], points)
    plain = np.flatnonzero(~robust)
    for chosen in (plain[exists[:, plain].all(axis=0)], *plain[~exists[:, plain].all(axis=0), None]):
        if len(chosen):
            coefficients[:, chosen] = _solve(design, penalty, target[:, chosen], weights[:, chosen[0]])
    residual = np.abs(design @ coefficients - target) * np.sqrt(weights)
    return coefficients, residual[points:].max(axis=1).reshape(d, points).T


def _on_grid(axes: Sequence[np.ndarray], knots: list[np.ndarray], slope_of: int | None) -> csr_array:
    factors = [basis(x, t, int(i == slope_of)) for i, (x, t) in enumerate(zip(axes, knots, strict=True))]
    return csr_array(reduce(kron, factors))


def _roughness(knots: list[np.ndarray]) -> csr_array:
    """The penalty: squared second differences of the coefficients along each axis, added up."""
    counts = [len(t) - DEGREE - 1 for t in knots]
    total = csr_array((np.prod(counts), np.prod(counts)))
    for axis in range(len(counts)):
        factors = [diags_array(np.ones(n)) for n in counts]
        n = counts[axis]
        second = diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(n - 2, n))
        factors[axis] = second.T @ second
        total = total + reduce(kron, factors)
    return csr_array(total)


def _solve(design: csr_array, penalty: csr_array, target: np.ndarray, weight: np.ndarray) -> np.ndarray:
    weighted = design.T @ diags_array(weight)
    normal = (weighted @ design).toarray()
    normal += _SMOOTHNESS * normal.trace() / len(normal) * penalty.toarray()
    return solve(normal, weighted @ target, assume_a="pos")


def _solve_robustly(
    design: csr_array, penalty: csr_array, target: np.ndarray, exists: np.ndarray, points: int
) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients, and the weights of the samples: reweighted least squares."""
    weight = exists.copy()
    weight[:points] *= _VALUE_WEIGHT
    for _ in range(_REWEIGHTINGS):
        coefficients = _solve(design, penalty, target, weight)
        slopes = design[points:] @ coefficients - target[points:]
        weight[points:] = exists[points:] / (1.0 + (slopes / _SLOPE_SCALE) ** 2)
    return coefficients, weight


def _refine(
    breaks: list[np.ndarray], axes: Sequence[np.ndarray], misfit: np.ndarray, tolerance: float, limits: Limits
) -> bool:
    """Halves the intervals where the slopes fit worst, in place, and returns whether it halved one."""
    misfit = misfit.reshape(*(len(axis) for axis in axes), len(axes))
    scores = []  # (misfit, axis, interval)
    for axis, (edges, x) in enumerate(zip(breaks, axes, strict=True)):
        others = tuple(i for i in range(len(axes)) if i != axis)
        along = misfit[..., axis].max(axis=others) if others else misfit[..., 0]
        interval = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
        for k, width in enumerate(np.diff(edges)):
            if width > 1.5 * limits.smallest * (x[-1] - x[0]):
                scores.append((along[interval == k].max(), axis, k))
    worst = max(scores, default=(0.0, 0, 0))[0]
    if worst <= tolerance:
        return False
    middles: list[list[float]] = [[] for _ in axes]
    for score, axis, k in sorted(scores, reverse=True):
        counts = [len(edges) + len(new) + DEGREE - 1 for edges, new in zip(breaks, middles, strict=True)]
        counts[axis] += 1
        if score > max(0.5 * worst, tolerance) and np.prod(counts) <= limits.coefficients:
            middles[axis].append(0.5 * (breaks[axis][k] + breaks[axis][k + 1]))
    breaks[:] = [np.sort([*edges, *new]) for edges, new in zip(breaks, middles, strict=True)]
    return any(middles)
