"""Terms of several coordinates: lengths are those of SciPy's tensor-product splines, moment arms minus their slopes."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.interpolate import NdBSpline

from drakearm.model import PathTerm, TensorTerm
from drakearm.model.inspection import inspect_arm
from drakearm.model.musculature import muscle_geometry
from drakearm.model.paths import (
    count_slopes,
    evaluate_path_curvatures,
    evaluate_path_lanes,
    evaluate_paths,
    make_path_pieces,
    make_path_table,
)
from tests.coupled_arm import with_tensor_paths

DEGREES = [(3, 3), (2, 4), (1, 1), (3, 3, 3), (1, 3, 2)]
STEP = 1e-5


def make_term(degrees, seed=0):
    rng = np.random.default_rng(seed)
    knots = [(*[-1.0] * (k + 1), *np.sort(rng.uniform(-0.8, 0.8, 3)), *[1.0] * (k + 1)) for k in degrees]
    counts = [len(each) - k - 1 for each, k in zip(knots, degrees, strict=True)]
    return TensorTerm(tuple("abc"[: len(degrees)]), tuple(knots), rng.uniform(-0.1, 0.1, counts).tolist())


def table_of(term):
    count = len(term.coordinates)
    order = tuple(reversed(range(count)))  # the first coordinate of the term is the arm's last one
    return make_path_table([], [(0, order, term.splines, np.array(term.coefficients))]), count


def evaluate(table, count, q):
    length, moment_arm, curvature = np.empty(1), np.empty((1, count)), np.empty((1, count, count))
    evaluate_paths(q, table, length, moment_arm)
    evaluate_path_curvatures(q, table, curvature)
    return length[0], moment_arm[0], curvature[0]


@pytest.mark.parametrize("degrees", DEGREES)
def test_length_is_that_of_the_tensor_product_spline(degrees):
    term = make_term(degrees)
    table, count = table_of(term)
    spline = NdBSpline(tuple(map(np.array, term.knots)), np.array(term.coefficients), degrees)
    for q in np.random.default_rng(1).uniform(-0.999, 0.999, (50, count)):
        length, moment_arm, _ = evaluate(table, count, q)
        assert length == pytest.approx(spline(q[::-1]).item(), abs=1e-12)
        slopes = [spline(q[::-1], nu=np.eye(count, dtype=int)[c]).item() for c in range(count)]
        np.testing.assert_allclose(moment_arm, -np.array(slopes)[::-1], atol=1e-10)


@pytest.mark.parametrize("degrees", DEGREES)
def test_moment_arms_and_curvatures_are_derivatives_everywhere(degrees):
    """Also outside of the knots."""
    table, count = table_of(make_term(degrees))
    for q in np.random.default_rng(2).uniform(-2.0, 2.0, (100, count)):
        _, moment_arm, curvature = evaluate(table, count, q)
        for j in range(count):
            step = STEP * np.eye(count)[j]
            after, before = evaluate(table, count, q + step), evaluate(table, count, q - step)
            assert moment_arm[j] == pytest.approx(-(after[0] - before[0]) / (2 * STEP), abs=1e-7)
            np.testing.assert_allclose(curvature[j], -(after[1] - before[1]) / (2 * STEP), atol=2e-5)
        np.testing.assert_allclose(curvature, curvature.T, atol=1e-12)


@pytest.mark.parametrize("degrees", DEGREES)
def test_the_length_is_linear_in_each_coordinate_outside_of_the_knots(degrees):
    table, count = table_of(make_term(degrees))
    q = np.random.default_rng(3).uniform(-0.9, 0.9, count)
    lengths = [evaluate(table, count, np.where(np.arange(count) == 0, out, q))[0] for out in (1.5, 2.0, 2.5)]
    assert lengths[2] - lengths[1] == pytest.approx(lengths[1] - lengths[0], abs=1e-12)


@pytest.mark.parametrize("lanes", [1, 5])
@pytest.mark.parametrize("degrees", DEGREES)
def test_many_arms_have_the_paths_of_each_arm_alone(degrees, lanes):
    """Beside a term of one coordinate of the same muscle."""
    term = make_term(degrees)
    count = len(degrees)
    one = PathTerm("a", (0.0, 0.0, 1.0, 1.0), (0.1, 0.3))
    table = make_path_table([(0, 0, one.spline)], [(0, range(count), term.splines, np.array(term.coefficients))])
    assert count_slopes(table) == 1 + count
    pieces = make_path_pieces(table, lanes)
    length, slope = np.empty((1, lanes)), np.empty((1 + count, lanes))
    rng = np.random.default_rng(4)
    for _ in range(20):
        q = rng.uniform(-2.0, 2.0, (count, lanes))
        evaluate_path_lanes(q, table, pieces, length, slope)
        for k in range(lanes):
            expected, moment_arm, _ = evaluate(table, count, np.ascontiguousarray(q[:, k]))
            assert length[0, k] == pytest.approx(expected, abs=1e-14)
            assert -slope[0, k] - slope[1, k] == pytest.approx(moment_arm[0], abs=1e-14)
            np.testing.assert_allclose(-slope[2:, k], moment_arm[1:], atol=1e-14)


def test_a_sum_of_two_splines_is_a_tensor_product_spline(arm):
    other = with_tensor_paths(arm)
    for q in np.random.default_rng(5).uniform([-1.0, 0.0], [1.8, 2.2], (50, 2)):
        expected, found = (muscle_geometry(q, a.muscle_table, a.path_table) for a in (arm, other))
        np.testing.assert_allclose(found[0], expected[0], atol=1e-14)
        np.testing.assert_allclose(found[1], expected[1], atol=1e-13)


def test_inspection_of_terms_of_several_coordinates(arm):
    expected, found = inspect_arm(arm), inspect_arm(with_tensor_paths(arm))
    for a, b in zip(expected.muscles, found.muscles, strict=True):
        for one, other in zip(a.crossings, b.crossings, strict=True):
            assert one.fitted == other.fitted and one.coordinate == other.coordinate
            np.testing.assert_allclose(other.moment_arm, one.moment_arm, atol=1e-12)
            inside = (one.q >= one.fitted.lower) & (one.q <= one.fitted.upper)
            # On a grid, extremes are found to within half a step of it.
            np.testing.assert_allclose(other.shortest[inside], one.shortest[inside], atol=2e-3)
            np.testing.assert_allclose(other.longest[inside], one.longest[inside], atol=2e-3)


KNOTS = (0.0, 0.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"coordinates": ("a",)}, "at least 2"),
        ({"coordinates": ("a", "a")}, "a is given twice"),
        ({"knots": (KNOTS,)}, "found 1 lists of knots, expected 2"),
        ({"coefficients": [0.1, 0.2]}, "one level of lists per coordinate"),
        ({"coefficients": [[0.1, 0.2], [0.1]]}, "lists of equal lengths"),
        ({"coefficients": [["x", "y"], ["z", "w"]]}, "numbers in lists"),
        ({"coefficients": [[0.1, float("nan")], [0.1, 0.2]]}, "finite numbers"),
        ({"coefficients": np.zeros((2, 2, 2)).tolist()}, "found 3 levels of lists, expected 2"),
        ({"coefficients": np.zeros((2, 4)).tolist()}, "b: found 4 knots for 4 coefficients"),
        ({"knots": (KNOTS, (0.0, 1.0, 0.5, 1.0))}, "b: expected knots in ascending order"),
        ({"knots": (KNOTS, (0.0, 0.0, 1e-4, 1e-4)), "coefficients": [[0, 1], [0, 1]]}, "b: found moment arms"),
    ],
)
def test_wrong_terms_are_refused_with_the_reason(fields, expected):
    good = {"coordinates": ("a", "b"), "knots": (KNOTS, KNOTS), "coefficients": [[0.1, 0.2], [0.1, 0.2]]}
    TensorTerm(**good)
    with pytest.raises(ValidationError, match=expected):
        TensorTerm(**{**good, **fields})
