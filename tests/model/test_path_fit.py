"""Fitted paths have the lengths and moment arms that were sampled, and are smooth where the samples jump."""

import numpy as np
import pytest

from drakearm.errors import PathError
from drakearm.model.path_fit import fit_paths
from drakearm.model.path_samples import with_differences

LOWER, UPPER = np.array([-1.0, 0.0, -0.5]), np.array([1.5, 2.0, 0.5])
COORDINATES = ("hip", "knee", "ankle")


def line(q):
    """Lengths of a straight line from 5 cm before the hip of a leg to its shank, in a plane."""
    knee = 0.4 * np.stack([np.sin(q[:, 0]), -np.cos(q[:, 0])])
    end = knee + 0.05 * np.stack([np.sin(q[:, 0] - q[:, 1]), -np.cos(q[:, 0] - q[:, 1])])
    return np.hypot(end[0] - 0.05, end[1])


def lengths(q):
    """A sum of functions of hip and ankle, a line over hip and knee, and a muscle that nothing moves."""
    return np.stack([0.3 + 0.04 * np.sin(q[:, 0]) - 0.02 * np.cos(2.0 * q[:, 2]), line(q), np.ones(len(q))], axis=1)


def jumping(q):
    """Three lengths, of which the first jumps by 8 mm at 0.7 rad, and the second in a range of 0.002 rad."""
    smooth = 0.3 + 0.04 * np.sin(q[:, 0])
    return np.stack([smooth - 0.008 * (q[:, 0] > 0.7), smooth + 0.05 * (np.abs(q[:, 0]) < 1e-3), smooth], axis=1)


def evaluate(fit, q):
    total = np.zeros(len(q))
    for term in fit.terms:
        total += term.evaluate(q[:, [COORDINATES.index(name) for name in term.coordinates]])[0]
    return total


def fitted(function=lengths, **options):
    names = [f"muscle{i}" for i in range(function(LOWER[None]).shape[1])]
    return fit_paths(with_differences(function), names, COORDINATES, LOWER, UPPER, **options)


def test_sums_become_one_spline_per_coordinate_and_others_one_of_several():
    assert [[term.coordinates for term in fit.terms] for fit in fitted()] == [
        [("hip",), ("ankle",)],
        [("hip", "knee")],
        [],
    ]


def test_errors_are_those_of_the_fitted_lengths_and_small():
    q = np.random.default_rng(2).uniform(LOWER, UPPER, (300, 3))
    expected = lengths(q)
    for i, fit in enumerate(fitted()[:2]):
        np.testing.assert_allclose(evaluate(fit, q), expected[:, i], atol=2e-5)
        assert fit.length_error.largest < 2e-5
        assert all(error.median <= error.largest < 1e-4 for error in fit.moment_arm_error.values())
        assert not fit.jumps


def test_moment_arms_are_minus_the_slopes_of_the_terms():
    hip_knee = fitted()[1].terms[0]
    q = np.random.default_rng(3).uniform(LOWER[:2] + 0.01, UPPER[:2] - 0.01, (20, 2))
    for j, step in enumerate(1e-6 * np.eye(2)):
        difference = (hip_knee.evaluate(q + step)[0] - hip_knee.evaluate(q - step)[0]) / 2e-6
        np.testing.assert_allclose(hip_knee.evaluate(q)[1][:, j], difference, atol=1e-8)


@pytest.mark.parametrize("size", [1e-3, 100.0])
def test_limbs_of_any_size_are_fitted_alike(size):
    for usual, other in zip(fitted(), fitted(lambda q: size * lengths(q)), strict=True):
        assert [term.coordinates for term in other.terms] == [term.coordinates for term in usual.terms]
        assert other.length_error.largest == pytest.approx(size * usual.length_error.largest, rel=0.1)
        q = np.random.default_rng(4).uniform(LOWER, UPPER, (50, 3))
        np.testing.assert_allclose(evaluate(other, q), size * evaluate(usual, q), rtol=1e-4)


def test_a_kink_gets_the_knots_that_it_needs():
    fit = fitted(lambda q: 0.3 + 0.02 * np.maximum(q[:, :1] - 0.31, 0.0) ** 2)[0]
    assert fit.moment_arm_error["hip"].largest < 5e-4
    assert fit.moment_arm_error["hip"].median < 1e-5
    knots = fit.terms[0].knots[0]
    assert np.abs(knots - 0.31).min() < 0.05
    assert np.diff(knots).max() > 0.5


def test_jumps_are_reported_and_cured():
    step, spike, smooth = fitted(jumping, reference=np.array([-0.5, 1.0, 0.0]))
    (jump,) = step.jumps
    assert (jump.coordinate, jump.angle, jump.size) == (0, pytest.approx(0.7, abs=1e-4), pytest.approx(-8e-3, rel=1e-2))
    assert not smooth.jumps
    q = np.linspace(LOWER, UPPER, 200)
    true = 0.3 + 0.04 * np.sin(q[:, 0])
    for fit in (step, spike):  # the level is that at the reference
        np.testing.assert_allclose(evaluate(fit, q), true, atol=2e-4)


def test_a_narrow_jump_is_found_if_it_is_searched_for():
    def narrow(q):
        return lengths(q)[:, :1] + 0.05 * ((q[:, :1] > 0.3003) & (q[:, :1] < 0.3013))

    assert not fitted(narrow)[0].jumps
    up, down = fitted(narrow, search=16)[0].jumps
    assert (up.angle, down.angle) == (pytest.approx(0.3003, abs=1e-5), pytest.approx(0.3013, abs=1e-5))
    assert (up.size, down.size) == (pytest.approx(0.05, rel=1e-3), pytest.approx(-0.05, rel=1e-3))


def test_the_reference_chooses_the_level_of_a_length_that_jumps():
    before, after = (fitted(jumping, reference=np.array([x, 1.0, 0.0]))[0] for x in (-0.5, 1.4))
    q = np.zeros((1, 3))
    assert evaluate(before, q) - evaluate(after, q) == pytest.approx(8e-3, abs=3e-4)


def test_samples_that_are_not_numbers_are_filled():
    def holed(q):
        return np.where(np.abs(q[:, :1] - 0.5) < 0.05, np.nan, lengths(q))

    q = np.linspace(LOWER, UPPER, 200)
    np.testing.assert_allclose(evaluate(fitted(holed)[0], q), lengths(q)[:, 0], atol=5e-5)


def test_the_same_samples_give_the_same_fit():
    for one, other in zip(fitted(), fitted(), strict=True):
        assert [term.fields() for term in one.terms] == [term.fields() for term in other.terms]


def test_more_than_three_coordinates_together_are_refused():
    sampler = with_differences(lambda q: np.sqrt(1.0 + 0.1 * q.prod(axis=1, keepdims=True)))
    with pytest.raises(PathError, match="The length of psoas depends on a, b, c, d together: expected at most 3"):
        fit_paths(sampler, ["psoas"], "abcd", np.zeros(4), np.ones(4))


def test_a_length_without_numbers_is_refused():
    with pytest.raises(PathError, match="muscle0 is not a number in any of 500 postures"):
        fitted(lambda q: np.full((len(q), 1), np.nan))


def test_a_length_without_numbers_mid_range_is_refused():
    with pytest.raises(PathError, match="moment arms of muscle0 are not numbers while other joints are mid-range"):
        fitted(lambda q: np.where(np.abs(q[:, :1] - 0.25) < 0.05, np.nan, lengths(q)))
