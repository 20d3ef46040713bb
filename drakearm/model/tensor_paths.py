"""Terms of path functions that depend on two or three coordinates together, compiled: tensor-product splines.

Such a term is a piecewise polynomial: a cell of the grid of knots has one polynomial in all coordinates. Outside of the
knots, each factor of its products continues along its tangent, so that the term and its slopes are continuous, and
moment arms are minus the derivatives of the same function everywhere.

A term in the table of `drakearm.model.paths` is:

- one header per coordinate: muscle, coordinate, and in the first one the number of coordinates in the fifth column. The
  last one has the number of rows that follow, the others 0;
- rows that hold these numbers one after the other: the order (coefficients per coordinate and cell), the number of
  knots of each coordinate, all knots (rad), and the coefficients (m) cell by cell. Both for cells and for coefficients,
  the index of the last coordinate changes first.
"""

from collections.abc import Sequence

import numpy as np

from drakearm.model.bspline import Spline
from drakearm.muscle.compiled import inner


def tensor_rows(
    muscle: int, coordinates: Sequence[int], splines: Sequence[Spline], coefficients: np.ndarray, width: int
) -> np.ndarray:
    """The rows of one term. splines: the B-splines of each coordinate, as of `TensorTerm`. width: of the table."""
    count, order = len(coordinates), max(spline.k for spline in splines) + 1
    numbers: list[np.ndarray] = []
    cells = np.array(coefficients)
    for axis, spline in enumerate(splines):
        powers = np.zeros((len(spline.knots) - 1, order, len(spline.c)))
        powers[:, : spline.k + 1] = spline.powers()
        numbers.append(spline.knots)
        cells = np.tensordot(powers, cells, axes=(2, 2 * axis))  # piece, power, and the other axes
        cells = np.moveaxis(cells, (0, 1), (2 * axis, 2 * axis + 1))
    cells = cells.transpose(*range(0, 2 * count, 2), *range(1, 2 * count, 2))
    flat = np.concatenate([[order], [len(knots) for knots in numbers], *numbers, cells.ravel()])
    rows = np.zeros((-(-len(flat) // width), width))
    rows.ravel()[: len(flat)] = flat
    headers = np.zeros((count, width))
    headers[:, 0], headers[:, 1] = muscle, coordinates
    headers[0, 4], headers[-1, 2] = count, len(rows)
    return np.concatenate([headers, rows])


@inner
def evaluate_tensor(q, paths, header, count, factors, sums):
    """Writes the value of a term into sums[0, 0] and its slope by its coordinate c into sums[1 + c, 0].

    q: angles (count,), rad, of its coordinates. header: the row of its first header. factors: scratch, see
    `make_tensor_scratch`; it holds the value, slope and curvature of each factor then. Returns the place of the cell's
    coefficients in the numbers of the term.
    """
    numbers = tensor_numbers(paths, header, count)
    order = int(numbers[0])
    place, cell = 1 + count, 0
    for c in range(count):
        knots = numbers[place : place + int(numbers[1 + c])]
        place += len(knots)
        x = min(max(q[c], knots[0]), knots[-1])
        piece = min(np.searchsorted(knots, x, side="right"), len(knots) - 1) - 1
        _powers(q[c], x, x - knots[piece], order, factors[:, c])
        cell = cell * (len(knots) - 1) + piece
    size = order**count
    place += cell * size
    sums[0, :size] = numbers[place : place + size]
    for c in range(count - 1, -1, -1):  # sums over the powers of one coordinate after the other, the last one first
        size //= order
        for s in range(size):
            value = slope = 0.0
            for o in range(order):
                value += factors[0, c, o] * sums[0, s * order + o]
                slope += factors[1, c, o] * sums[0, s * order + o]
            for other in range(c + 1, count):
                total = 0.0
                for o in range(order):
                    total += factors[0, c, o] * sums[1 + other, s * order + o]
                sums[1 + other, s] = total
            sums[0, s] = value
            sums[1 + c, s] = slope
    return place


@inner
def tensor_numbers(paths, header, count):
    """The numbers of a term, one after the other."""
    first = header + count
    return paths[first : first + int(paths[first - 1, 2])].ravel()


@inner
def tensor_scratch(paths, header, count):
    """Working memory of `evaluate_tensor` for a term: factors and sums."""
    order = int(paths[header + count, 0])
    return np.empty((3, count, order)), np.empty((1 + count, order**count))


@inner
def _powers(q, x, t, order, factors):
    """Values, slopes and curvatures (3, order) at q of t^o, which continue along their tangent beyond x."""
    value, slope, curve = 1.0, 0.0, 0.0
    for o in range(order):
        factors[0, o], factors[1, o], factors[2, o] = value, slope, curve
        curve = curve * t + 2.0 * slope
        slope = slope * t + value
        value = value * t
    if q != x:
        for o in range(order):
            factors[0, o] += factors[1, o] * (q - x)
            factors[2, o] = 0.0


@inner
def tensor_curvature(paths, header, count, place, factors, i, j):
    """The derivative of a term by its coordinates i and j, m/rad^2. place, factors: of `evaluate_tensor`."""
    numbers = tensor_numbers(paths, header, count)
    order = int(numbers[0])
    total = 0.0
    for k in range(order**count):
        product, rest = numbers[place + k], k
        for c in range(count - 1, -1, -1):
            product *= factors[int(c == i) + int(c == j), c, rest % order]
            rest //= order
        total += product
    return total
