"""Path functions: musculotendon lengths and moment arms as functions of the joint angles.

The length of a muscle is a sum of one-dimensional splines, one for each coordinate that it crosses. Outside its knots a
spline continues along its tangent. A moment arm is minus the derivative of the same function, so the two never
disagree.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.interpolate import BSpline

TERM_DTYPE = np.dtype(
    [
        ("muscle", np.int64),
        ("coordinate", np.int64),
        ("first", np.int64),  # row of the first piece
        ("last", np.int64),  # row that only holds the end of the last piece
    ],
    align=True,
)


class PathTable(NamedTuple):
    """Splines of all muscles as polynomial pieces, for the compiled functions.

    terms: one record of `TERM_DTYPE` a spline. pieces: one row a piece, where it starts (rad) and the coefficients c_j
    (m) of sum_j c_j * (q - start)^j; the piece ends where the next row starts.
    """

    terms: np.ndarray
    pieces: np.ndarray


def make_path_table(terms: list[tuple[int, int, BSpline]]) -> PathTable:
    """The table of (muscle, coordinate, spline) terms; spline degrees may differ."""
    order = 1 + max((spline.k for _, _, spline in terms), default=0)
    records, blocks, first = [], [], 0
    for muscle, coordinate, spline in terms:
        knots = np.unique(spline.t[spline.k : len(spline.t) - spline.k])
        block = np.zeros((len(knots), 1 + order))
        block[:, 0] = knots
        for j in range(spline.k + 1):
            block[:-1, 1 + j] = spline(knots[:-1], nu=j) / math.factorial(j)
        blocks.append(block)
        records.append((muscle, coordinate, first, first + len(knots) - 1))
        first += len(knots)
    return PathTable(np.array(records, dtype=TERM_DTYPE), np.concatenate(blocks))


@njit(cache=True, error_model="numpy")
def _evaluate_term(q, first, last, pieces):
    """Value, first and second derivative at q of the spline in the rows first to last."""
    x = min(max(q, pieces[first, 0]), pieces[last, 0])
    row = first
    while row + 1 < last and x >= pieces[row + 1, 0]:
        row += 1
    t = x - pieces[row, 0]
    value = slope = curve = 0.0
    for j in range(pieces.shape[1] - 1, 0, -1):
        curve = curve * t + 2.0 * slope
        slope = slope * t + value
        value = value * t + pieces[row, j]
    if q == x:
        return value, slope, curve
    return value + slope * (q - x), slope, 0.0


@njit(cache=True, error_model="numpy")
def evaluate_paths(q, paths, length, moment_arm):
    """Writes lengths (n,) and moment arms (n, n_q), both in m, at the joint angles q (n_q,) in rad."""
    length[:] = 0.0
    moment_arm[:] = 0.0
    for k in range(len(paths.terms)):
        term = paths.terms[k]
        i, j = term.muscle, term.coordinate
        value, slope, _ = _evaluate_term(q[j], term.first, term.last, paths.pieces)
        length[i] += value
        moment_arm[i, j] -= slope


@njit(cache=True, error_model="numpy")
def evaluate_path_curvatures(q, paths, curvature):
    """Writes the second derivatives (n, n_q) of the lengths, in m/rad^2; mixed ones vanish because lengths are sums."""
    curvature[:] = 0.0
    for k in range(len(paths.terms)):
        term = paths.terms[k]
        j = term.coordinate
        _, _, second = _evaluate_term(q[j], term.first, term.last, paths.pieces)
        curvature[term.muscle, j] += second
