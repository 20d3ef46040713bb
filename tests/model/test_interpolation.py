"""The coefficients of trigonometric polynomials are found from samples."""

import numpy as np
import pytest

from drakearm.model.interpolation import coefficients, sample_points, terms


def evaluate(c: np.ndarray, x: np.ndarray, degree: int) -> np.ndarray:
    """The polynomials with coefficients (K, ...) at angles (n,)."""
    factors = [np.ones_like(x)]
    for m in range(1, degree + 1):
        factors += [np.cos(m * x), np.sin(m * x)]
    n = len(x)
    products = np.array([np.prod([factors[f][j] for j, f in enumerate(term)]) for term in terms(degree, n)])
    return np.tensordot(products, c, axes=1)


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("n", [1, 2, 3])
def test_coefficients_are_found(degree, n):
    expected = np.random.default_rng(0).normal(size=((2 * degree + 1) ** n, 2, 3))
    samples = np.array([evaluate(expected, x, degree) for x in sample_points(degree, n)])
    np.testing.assert_allclose(coefficients(samples, degree, n), expected, atol=1e-13)


def test_known_coefficients():
    """2 + 3 sin x cos 2 y has two terms."""
    samples = np.array([2.0 + 3.0 * np.sin(x) * np.cos(2.0 * y) for x, y in sample_points(2, 2)])
    found = coefficients(samples, 2, 2)
    expected = np.zeros(25)
    expected[0], expected[terms(2, 2).tolist().index([2, 3])] = 2.0, 3.0
    np.testing.assert_allclose(found, expected, atol=1e-15)


def test_samples_in_any_memory_layout_give_the_same_bits():
    samples = np.random.default_rng(1).normal(size=(25, 7))
    expected = coefficients(samples, 2, 2)
    for offset in range(1, 8):  # other alignments in memory
        memory = np.empty(samples.size + offset)
        moved = memory[offset:].reshape(samples.shape)
        moved[:] = samples
        np.testing.assert_array_equal(coefficients(moved, 2, 2), expected)
    np.testing.assert_array_equal(coefficients(np.asfortranarray(samples), 2, 2), expected)
