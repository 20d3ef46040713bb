"""Trigonometric polynomials of several angles: their exact coefficients, from samples at evenly spaced angles.

A polynomial of degree d in an angle x has 2 d + 1 terms: 1, cos x, sin x, ..., cos d x, sin d x. Its samples at 2 d + 1
evenly spaced angles give the coefficients as weighted sums (the discrete Fourier transform). With several angles the
terms are products, with one factor per angle, and the sums are taken for one angle after the other.

Plain sums in a fixed order, and no matrix library: the same samples give the same coefficients, bit for bit.
"""

import math
from itertools import product

import numpy as np


def terms(degree: int, n: int) -> np.ndarray:
    """The terms (K, n) of a polynomial of n angles: the index of the factor of each angle, 0 for 1, 1 for cos x, ..."""
    return np.array(list(product(range(2 * degree + 1), repeat=n)))


def sample_points(degree: int, n: int) -> np.ndarray:
    """The angles (K, n), rad, at which a polynomial must be sampled, with as many samples as there are terms."""
    return 2.0 * np.pi / (2 * degree + 1) * terms(degree, n)


def coefficients(samples: np.ndarray, degree: int, n: int) -> np.ndarray:
    """The coefficients (K, ...) of the terms, from samples (K, ...) at the sample points."""
    count = 2 * degree + 1
    c = samples.reshape(*[count] * n, -1)
    for axis in range(n):
        along = np.moveaxis(c, axis, 0)
        sums = [sum(w * sample for w, sample in zip(row, along, strict=True)) for row in _weights(degree)]
        c = np.moveaxis(np.array(sums), 0, axis)
    return np.ascontiguousarray(c.reshape(samples.shape))


def _weights(degree: int) -> list[list[float]]:
    """What each sample (column) contributes to the coefficient of each term (row) of one angle."""
    count = 2 * degree + 1
    rows = [[1.0 / count] * count]
    for m in range(1, degree + 1):
        angles = [2.0 * math.pi * (m * k % count) / count for k in range(count)]  # m x at the samples
        rows += [[2.0 / count * function(angle) for angle in angles] for function in (math.cos, math.sin)]
    return rows
