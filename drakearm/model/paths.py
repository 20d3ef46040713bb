"""Path functions: musculotendon lengths and moment arms as functions of the joint angles.

The length of a muscle is a sum of terms: one spline for each coordinate that the muscle crosses, or splines of several
coordinates (`drakearm.model.tensor_paths`) where the length is no such sum. Outside its knots a spline continues along
its tangent. A moment arm is minus the derivative of the same spline, so lengths and moment arms always agree.

`evaluate_paths` computes one posture. `evaluate_path_lanes` computes many, one per lane, and remembers which piece of a
spline each lane is in. tests/model/test_paths.py compares the two. `drakearm.muscle.compiled` explains lanes.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drakearm.model.bspline import Spline
from drakearm.model.tensor_paths import evaluate_tensor, tensor_curvature, tensor_rows, tensor_scratch
from drakearm.muscle.compiled import fma, inlined, inner

_LEAST_ORDER = 4  # coefficients per piece, at least: those of a cubic spline, and the five numbers of a header fit in


def make_path_table(
    terms: Sequence[tuple[int, int, Spline]],
    tensor_terms: Sequence[tuple[int, Sequence[int], Sequence[Spline], np.ndarray]] = (),
) -> np.ndarray:
    """The terms (muscle, coordinate, spline) as a table of polynomial pieces, for the compiled functions.

    tensor_terms: those of several coordinates (muscle, coordinates, splines, coefficients), see `tensor_rows`.

    The table has these rows for each term of one coordinate, one term after the other, and then the tensor terms:

    - a header: muscle, coordinate, number of knots; and 1 if the previous term has the same coordinate and knots, or 0;
    - one row per knot: the knot (rad), and the coefficients c_j (m) of the polynomial sum_j c_j (q - knot)^j that holds
      from this knot to the next.

    Splines may have different degrees. All terms are in one array because each additional argument of a call from
    Python takes as much time as ten splines.
    """
    order = max([_LEAST_ORDER] + [spline.k + 1 for _, _, spline in terms])
    rows = [np.zeros((0, 1 + order))]
    before: tuple[int, list[float]] = (-1, [])
    for muscle, coordinate, spline in sorted(terms, key=lambda term: (term[1], term[2].knots.tolist())):
        knots = spline.knots
        header, pieces = np.zeros((1, 1 + order)), np.zeros((len(knots), 1 + order))
        header[0, :4] = muscle, coordinate, len(knots), before == (coordinate, knots.tolist())
        pieces[:, 0] = knots
        pieces[:-1, 1 : 2 + spline.k] = spline.powers()
        rows += [header, pieces]
        before = (coordinate, knots.tolist())
    rows += [tensor_rows(*term, width=1 + order) for term in tensor_terms]
    return np.concatenate(rows)


def count_slopes(paths: np.ndarray) -> int:
    """The number of slopes of all terms in a table: each term has one per coordinate."""
    slopes = header = 0
    while header < len(paths):
        slopes += 1
        header += 1 + int(paths[header, 2])
    return slopes


class PathPieces(NamedTuple):
    """The piece of each term that each lane is in. It is kept between calls, because lanes rarely change pieces."""

    found: np.ndarray  # (lanes,), scratch: the piece that a lane has just entered, or -1 if it has stayed
    start: np.ndarray  # (terms, lanes), rad: the piece is used from this angle; -inf for the first piece
    stop: np.ndarray  # (terms, lanes), rad: to this angle; inf for the last piece
    knot: np.ndarray  # (terms, lanes), rad: the knot at which the piece begins
    coefficients: np.ndarray  # (order, terms, lanes)


def make_path_pieces(paths: np.ndarray, lanes: int) -> PathPieces:
    """PathPieces for a number of lanes, none of which has found its piece yet."""
    terms, order = count_slopes(paths), paths.shape[1] - 1
    return PathPieces(
        np.empty(lanes, np.int64),
        np.full((terms, lanes), np.inf),
        np.full((terms, lanes), -np.inf),
        np.empty((terms, lanes)),
        np.empty((order, terms, lanes)),
    )


@inlined
def _follow_pieces(q, j, paths, first, last, found, start, stop, knot, term):
    """Finds the pieces at q[j] of the lanes that have left theirs, and returns whether there were such lanes.

    first, last: rows of the term's first and last knot in `paths`.
    """
    left = 0
    for k in range(len(found)):
        left += not (start[term, k] <= q[j, k] < stop[term, k])
    if left == 0:
        return False
    for k in range(len(found)):
        found[k] = -1
        if not (start[term, k] <= q[j, k] < stop[term, k]):
            row = first
            while row + 1 < last and q[j, k] >= paths[row + 1, 0]:
                row += 1
            found[k] = row - first
            knot[term, k] = paths[row, 0]
            start[term, k] = paths[row, 0] if row > first else -np.inf
            stop[term, k] = paths[row + 1, 0] if row + 1 < last else np.inf
    return True


@inner
def evaluate_path_lanes(q, paths, pieces, length, slope):
    """Writes lengths (n, lanes), m, and the slopes of the terms (terms, lanes), m/rad, at joint angles q (n_q, lanes).

    pieces: see `make_path_pieces`. A moment arm is minus the slope of a term; a term of several coordinates has one row
    of slopes for each of them. Consecutive terms with the same coordinate and knots form a group: their lanes are in
    the same pieces, which are found only once.
    """
    found, start, stop, knot, c = pieces
    lanes, order = len(found), len(c)
    length[:] = 0.0
    header = 0
    term = group = np.int64(0)  # for a plain 0 Numba would compile `_follow_pieces` a second time
    moved = False
    while header < len(paths):
        i, j = int(paths[header, 0]), int(paths[header, 1])
        if paths[header, 4] > 1.0:
            count = int(paths[header, 4])
            _tensor_lanes(q, paths, header, count, length[i], slope[term : term + count])
            header += count + int(paths[header + count - 1, 2])
            term += count
            continue
        first, last = header + 1, header + int(paths[header, 2])
        if paths[header, 3] == 0.0:
            group = term
            moved = _follow_pieces(q, j, paths, first, last, found, start, stop, knot, group)
        if moved:
            for k in range(lanes):
                if found[k] >= 0:
                    for o in range(order):
                        c[o, term, k] = paths[first + found[k], 1 + o]
        lowest, highest = paths[first, 0], paths[last, 0]
        if order == 4:
            for k in range(lanes):
                x = min(max(q[j, k], lowest), highest)
                t = x - knot[group, k]
                c1, c2, c3 = c[1, term, k], c[2, term, k], c[3, term, k]
                rate = fma(t, fma(3.0 * t, c3, 2.0 * c2), c1)
                value = fma(t, fma(t, fma(t, c3, c2), c1), c[0, term, k])
                length[i, k] += fma(rate, q[j, k] - x, value)
                slope[term, k] = rate
        else:
            for k in range(lanes):
                x = min(max(q[j, k], lowest), highest)
                t = x - knot[group, k]
                value = rate = 0.0
                for o in range(order - 1, -1, -1):
                    rate = fma(rate, t, value)
                    value = fma(value, t, c[o, term, k])
                length[i, k] += fma(rate, q[j, k] - x, value)
                slope[term, k] = rate
        header = last + 1
        term += 1


@inner
def _tensor_lanes(q, paths, header, count, length, slope):
    """Adds a term of several coordinates to the lengths (lanes,), and writes its slopes (count, lanes)."""
    factors, sums = tensor_scratch(paths, header, count)
    own = np.empty(count)
    for k in range(len(length)):
        for c in range(count):
            own[c] = q[int(paths[header + c, 1]), k]
        evaluate_tensor(own, paths, header, count, factors, sums)
        length[k] += sums[0, 0]
        for c in range(count):
            slope[c, k] = sums[1 + c, 0]


@inner
def _evaluate_term(q, rows):
    """Value, first and second derivative at q of one spline. rows: those of its knots in the path table."""
    last = len(rows) - 2
    x = min(max(q, rows[0, 0]), rows[last + 1, 0])
    piece = 0
    while piece < last and x >= rows[piece + 1, 0]:
        piece += 1
    t = x - rows[piece, 0]
    value = slope = curve = 0.0
    for j in range(rows.shape[1] - 1, 0, -1):
        curve = curve * t + 2.0 * slope
        slope = slope * t + value
        value = value * t + rows[piece, j]
    if q == x:
        return value, slope, curve
    return value + slope * (q - x), slope, 0.0


@inner
def evaluate_paths(q, paths, length, moment_arm):
    """Writes lengths (n,) and moment arms (n, n_q), both in m, at the joint angles q (n_q,) in rad."""
    length[:] = 0.0
    moment_arm[:] = 0.0
    header = 0
    while header < len(paths):
        i, j = int(paths[header, 0]), int(paths[header, 1])
        if paths[header, 4] > 1.0:
            count = int(paths[header, 4])
            factors, sums = tensor_scratch(paths, header, count)
            evaluate_tensor(_own(q, paths, header, count), paths, header, count, factors, sums)
            length[i] += sums[0, 0]
            for c in range(count):
                moment_arm[i, int(paths[header + c, 1])] -= sums[1 + c, 0]
            header += count + int(paths[header + count - 1, 2])
        else:
            end = header + 1 + int(paths[header, 2])
            value, slope, _ = _evaluate_term(q[j], paths[header + 1 : end])
            length[i] += value
            moment_arm[i, j] -= slope
            header = end


@inner
def evaluate_path_curvatures(q, paths, curvature):
    """Writes the second derivatives (n, n_q, n_q) of the lengths, m/rad^2."""
    curvature[:] = 0.0
    header = 0
    while header < len(paths):
        i, j = int(paths[header, 0]), int(paths[header, 1])
        if paths[header, 4] > 1.0:
            count = int(paths[header, 4])
            factors, sums = tensor_scratch(paths, header, count)
            place = evaluate_tensor(_own(q, paths, header, count), paths, header, count, factors, sums)
            for c in range(count):
                for d in range(count):
                    second = tensor_curvature(paths, header, count, place, factors, c, d)
                    curvature[i, int(paths[header + c, 1]), int(paths[header + d, 1])] += second
            header += count + int(paths[header + count - 1, 2])
        else:
            end = header + 1 + int(paths[header, 2])
            curvature[i, j, j] += _evaluate_term(q[j], paths[header + 1 : end])[2]
            header = end


@inner
def _own(q, paths, header, count):
    """The angles (count,) of the coordinates of a term of several coordinates."""
    own = np.empty(count)
    for c in range(count):
        own[c] = q[int(paths[header + c, 1])]
    return own
