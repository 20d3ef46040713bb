"""Pieces of B-splines: the same numbers as those of SciPy."""

import math

import numpy as np
import pytest
from scipy.interpolate import BSpline

from drakearm.model import load_arm
from drakearm.model.bspline import Spline
from drakearm.model.path_terms import TensorTerm


def powers_of_scipy(spline):
    orders = range(spline.k + 1)
    return np.stack([BSpline(*spline)(spline.knots[:-1], nu=j) / math.factorial(j) for j in orders], axis=1)


@pytest.mark.parametrize("arm", ["arm14", "arm26", "rat_hindlimb"])
def test_the_pieces_of_shipped_paths_are_those_of_scipy(arm):
    terms = [term for muscle in load_arm(arm).muscles for term in muscle.path]
    splines = [spline for term in terms for spline in (term.splines if isinstance(term, TensorTerm) else [term.spline])]
    assert splines
    for spline in splines:
        np.testing.assert_allclose(spline.powers(), powers_of_scipy(spline), rtol=1e-13, atol=1e-16)


@pytest.mark.parametrize("columns", [(), (3,), (2, 2)])
@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_the_pieces_of_any_spline_are_those_of_scipy(degree, columns):
    """Also where knots are repeated, and where there are knots outside the range."""
    rng = np.random.default_rng(degree)
    inner = np.sort(rng.uniform(-1.0, 1.0, 4))
    knots = np.concatenate([np.linspace(-2.0, -1.0, degree + 1), inner, inner[-1:], np.linspace(1.0, 1.5, degree + 1)])
    spline = Spline(knots, rng.standard_normal((len(knots) - degree - 1, *columns)), degree)
    assert spline.powers().shape == (len(spline.knots) - 1, degree + 1, *columns)
    np.testing.assert_allclose(spline.powers(), powers_of_scipy(spline), rtol=1e-12, atol=1e-12)
