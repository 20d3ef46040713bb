"""B-splines as the polynomial pieces that compiled path functions use."""

import math
from typing import NamedTuple

import numpy as np


class Spline(NamedTuple):
    """A B-spline. It has the names and the order of SciPy's: `scipy.interpolate.BSpline(*spline)` evaluates it.

    SciPy itself is not used here, because it takes 0.3 s to import, and each program that moves an arm comes here.
    """

    t: np.ndarray  # knots
    c: np.ndarray  # coefficients, along the first axis
    k: int  # degree

    @property
    def knots(self) -> np.ndarray:
        """The angles (rad) at which pieces begin and end, in ascending order, without the knots outside the range."""
        return np.unique(self.t[self.k : len(self.t) - self.k])

    def powers(self) -> np.ndarray:
        """The coefficients c_j of the polynomials sum_j c_j (q - knot)^j: (pieces, degree + 1, ...).

        A piece holds from its knot to the next. Axes after the second are those of the coefficients.
        """
        orders = range(self.k + 1)
        return np.array([[self._derivative(x, j) / math.factorial(j) for j in orders] for x in self.knots[:-1]])

    def _derivative(self, x: float, order: int) -> np.ndarray:
        """The derivative of an order (0: the value) at the beginning x of a piece."""
        first = int(np.searchsorted(self.t, x, side="right")) - 1 - self.k
        value = np.zeros(self.c.shape[1:])
        for i, weight in enumerate(self._weights(x, order)):
            value = value + self.c[first + i] * weight
        return value

    def _weights(self, x: float, order: int) -> list[float]:
        """What each of the degree + 1 coefficients of a piece contributes to a derivative at x (de Boor 1972, eq. 4).

        The B-splines of one degree follow from those of the degree below, and derivatives from differences of these.
        """
        t, piece = self.t, int(np.searchsorted(self.t, x, side="right")) - 1
        weights = [1.0]
        for degree in range(1, self.k + 1):
            below, weights = weights, [0.0] * (degree + 1)
            for n in range(1, degree + 1):
                left, right = t[piece + n - degree], t[piece + n]
                if left == right:
                    continue
                if degree <= self.k - order:
                    share = below[n - 1] / (right - left)
                    weights[n - 1] += share * (right - x)
                    weights[n] = share * (x - left)
                else:
                    slope = degree * below[n - 1] / (right - left)
                    weights[n - 1] -= slope
                    weights[n] = slope
        return weights
