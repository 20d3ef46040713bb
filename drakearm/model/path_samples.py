"""What fits of path functions need to know about sampled paths: which coordinates matter, and where lengths jump."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from drakearm.model.spline_fit import Grid

# Joint angles (m, n_q), rad -> lengths (m, n), m, and moment arms (m, n, n_q), m: minus the slopes of the lengths.
PathSampler = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]

_STEP = 1e-4  # rad, of finite differences
_BROKEN = 1e-2  # m: where the two one-sided slopes differ by more, there is no slope
_POSTURES = 64
_IGNORED = 1e-6  # m: smaller moment arms are rounding errors of the wrapping
_SMALLEST_JUMP = 2e-4  # m
_NARROW = 1e-5  # rad: a length that changes within this is a jump
_MOST_JUMPS = 12  # per muscle and coordinate that are searched for


class Jump(NamedTuple):
    """A sudden change of a muscle's length, as where wrapping changes sides."""

    coordinate: int
    angle: float  # rad
    size: float  # m


def with_differences(lengths: Callable[[np.ndarray], np.ndarray]) -> PathSampler:
    """A sampler for paths that have lengths only: moment arms by central differences, NaN where the length jumps.

    lengths: joint angles (m, n_q) -> lengths (m, n). It is also asked 0.0001 rad outside the range.
    """

    def sample(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        middle = lengths(q)
        arms = np.empty((*middle.shape, q.shape[1]))
        for j in range(q.shape[1]):
            step = np.zeros(q.shape[1])
            step[j] = _STEP
            before, after = lengths(q - step), lengths(q + step)
            arms[..., j] = (before - after) / (2.0 * _STEP)
            arms[np.abs(before - 2.0 * middle + after) > _BROKEN * _STEP, j] = np.nan
        return middle, arms

    return sample


def find_components(
    sample: PathSampler, lower: np.ndarray, upper: np.ndarray, tolerance: float
) -> list[list[tuple[int, ...]]]:
    """For each muscle, groups of coordinates: its length is a sum of one function per group.

    Two coordinates are in one group if the moment arm of one changes with the other by more than tolerance (m).
    """
    rng = np.random.default_rng(0)
    n_q = len(lower)
    postures = rng.uniform(lower, upper, (_POSTURES, n_q))
    arms = sample(postures)[1]
    matters = np.nan_to_num(np.abs(arms)).max(axis=0) > _IGNORED  # (n, n_q)
    coupled = np.zeros((arms.shape[1], n_q, n_q), bool)
    for k in range(n_q):
        moved = postures.copy()
        moved[:, k] = rng.uniform(lower[k], upper[k], _POSTURES)
        differs = np.abs(sample(moved)[1] - arms) > tolerance
        coupled[:, :, k] = differs.mean(axis=0) > 0.05  # fewer are errors of the wrapping
    coupled |= coupled.transpose(0, 2, 1)
    return [_connected(np.flatnonzero(matters[i]).tolist(), coupled[i]) for i in range(len(coupled))]


def _connected(coordinates: list[int], coupled: np.ndarray) -> list[tuple[int, ...]]:
    groups: list[set[int]] = []
    for j in coordinates:
        together = [group for group in groups if any(coupled[j, k] for k in group)]
        groups = [group for group in groups if group not in together] + [{j}.union(*together)]
    return sorted(tuple(sorted(group)) for group in groups)


def sample_grid(sample: PathSampler, center: np.ndarray, coordinates: tuple[int, ...], axes: list[np.ndarray]) -> Grid:
    """Lengths and their slopes, for all muscles, on a grid of some coordinates, with the others at the center."""
    mesh = np.meshgrid(*axes, indexing="ij")
    q = np.tile(center, (mesh[0].size, 1))
    q[:, coordinates] = np.stack([m.ravel() for m in mesh], axis=1)
    length, arms = sample(q)
    return Grid(axes, length, -arms[:, :, coordinates])


def find_jumps(
    sample: PathSampler, center: np.ndarray, coordinates: tuple[int, ...], grid: Grid, muscle: int
) -> list[Jump]:
    """The jumps of one muscle's length along the line of the grid where it jumps most, for each coordinate.

    At a jump the length changes by more than the slopes say, however small the step is.
    """
    shape = [len(axis) for axis in grid.axes]
    values = grid.values[:, muscle].reshape(shape)
    jumps = []
    for axis, (j, x) in enumerate(zip(coordinates, grid.axes, strict=True)):
        lines = np.moveaxis(values, axis, -1)
        slopes = np.moveaxis(np.nan_to_num(grid.slopes[:, muscle, axis]).reshape(shape), axis, -1)
        excess = np.abs(np.diff(lines) - 0.5 * (slopes[..., 1:] + slopes[..., :-1]) * np.diff(x))
        line = np.unravel_index(np.argmax(np.nan_to_num(excess).max(axis=-1)), excess.shape[:-1])
        posture = center.copy()
        others = [a for a in range(len(shape)) if a != axis]
        for a, index in zip(others, line, strict=True):
            posture[coordinates[a]] = grid.axes[a][index]
        intervals = np.argsort(-np.nan_to_num(excess[line]), kind="stable")[:_MOST_JUMPS]
        for k in sorted(intervals[excess[line][intervals] > _SMALLEST_JUMP].tolist()):
            jump = _bisected(sample, posture, j, (x[k], x[k + 1]), muscle)
            if abs(jump.size) > _SMALLEST_JUMP:
                jumps.append(jump)
    return jumps


def _bisected(sample: PathSampler, posture: np.ndarray, j: int, ends: tuple[float, float], muscle: int) -> Jump:
    """The largest jump between two angles: always the half in which the length changes most unexpectedly."""

    def at(angle: float) -> tuple[float, float, float]:
        q = posture.copy()
        q[j] = angle
        length, arms = sample(q[None])
        return angle, length[0, muscle], -np.nan_to_num(arms[0, muscle, j])

    def excess(a: tuple, b: tuple) -> float:
        return b[1] - a[1] - 0.5 * (a[2] + b[2]) * (b[0] - a[0])

    low, high = at(ends[0]), at(ends[1])
    while high[0] - low[0] > _NARROW:
        middle = at(0.5 * (low[0] + high[0]))
        if abs(excess(low, middle)) > abs(excess(middle, high)):
            high = middle
        else:
            low = middle
    return Jump(j, 0.5 * (low[0] + high[0]), excess(low, high))
