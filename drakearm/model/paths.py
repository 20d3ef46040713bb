"""Path functions: musculotendon lengths and moment arms as functions of the joint angles.

The length of a muscle is a sum of one-dimensional splines, one for each coordinate that it crosses. Outside its knots a
spline continues along its tangent. A moment arm is minus the derivative of the same function, so the two never
disagree.
"""

import math

import numpy as np
from scipy.interpolate import BSpline

from drakearm.muscle.compiled import compiled

_CLOSING = -1.0  # in place of the muscle: this row only says where the row before it ends


def make_path_table(terms: list[tuple[int, int, BSpline]]) -> np.ndarray:
    """The splines of (muscle, coordinate, spline) terms as polynomial pieces, for the compiled functions.

    Each row is a piece: muscle, coordinate, start (rad), and the coefficients c_j (m) of sum_j c_j (q - start)^j. The
    rows of a term follow each other; a row with muscle -1 closes it. Spline degrees may differ. It is one array because
    each further argument would cost a call from Python as much as ten splines.
    """
    order = 1 + max((spline.k for _, _, spline in terms), default=0)
    blocks = [np.zeros((0, 3 + order))]
    for muscle, coordinate, spline in terms:
        knots = np.unique(spline.t[spline.k : len(spline.t) - spline.k])
        block = np.zeros((len(knots), 3 + order))
        block[:, 0] = muscle
        block[-1, 0] = _CLOSING
        block[:, 1] = coordinate
        block[:, 2] = knots
        for j in range(spline.k + 1):
            block[:-1, 3 + j] = spline(knots[:-1], nu=j) / math.factorial(j)
        blocks.append(block)
    return np.concatenate(blocks)


@compiled
def _last_row(first, paths):
    """The row that closes the term which begins in a row."""
    last = first
    while paths[last, 0] != _CLOSING:
        last += 1
    return last


@compiled
def _evaluate_term(q, first, last, paths):
    """Value, first and second derivative at q of the spline in the rows first to last."""
    x = min(max(q, paths[first, 2]), paths[last, 2])
    row = first
    while row + 1 < last and x >= paths[row + 1, 2]:
        row += 1
    t = x - paths[row, 2]
    value = slope = curve = 0.0
    for j in range(paths.shape[1] - 1, 2, -1):
        curve = curve * t + 2.0 * slope
        slope = slope * t + value
        value = value * t + paths[row, j]
    if q == x:
        return value, slope, curve
    return value + slope * (q - x), slope, 0.0


@compiled
def evaluate_paths(q, paths, length, moment_arm):
    """Writes lengths (n,) and moment arms (n, n_q), both in m, at the joint angles q (n_q,) in rad."""
    length[:] = 0.0
    moment_arm[:] = 0.0
    first = 0
    while first < len(paths):
        last = _last_row(first, paths)
        i, j = int(paths[first, 0]), int(paths[first, 1])
        value, slope, _ = _evaluate_term(q[j], first, last, paths)
        length[i] += value
        moment_arm[i, j] -= slope
        first = last + 1


@compiled
def evaluate_path_curvatures(q, paths, curvature):
    """Writes the second derivatives (n, n_q) of the lengths (m/rad^2); mixed ones vanish, as lengths are sums."""
    curvature[:] = 0.0
    first = 0
    while first < len(paths):
        last = _last_row(first, paths)
        i, j = int(paths[first, 0]), int(paths[first, 1])
        curvature[i, j] += _evaluate_term(q[j], first, last, paths)[2]
        first = last + 1
