"""Path functions: lengths are those of the splines, and moment arms minus their slopes, in and outside the knots."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from drakearm.model import load_arm
from drakearm.model.bspline import Spline
from drakearm.model.musculature import muscle_geometry
from drakearm.model.paths import (
    count_slopes,
    evaluate_path_curvatures,
    evaluate_path_lanes,
    evaluate_paths,
    make_path_pieces,
    make_path_table,
)

ARM = load_arm("arm14")
angles = st.floats(-3.0, 3.0)


def geometry(*q):
    return muscle_geometry(np.array(q), ARM.muscle_table, ARM.path_table)


@settings(max_examples=200, deadline=None)
@given(angles, angles)
def test_moment_arm_is_minus_the_slope_of_the_length_everywhere(shoulder, elbow):
    step = 1e-6
    _, moment_arm = geometry(shoulder, elbow)
    by_shoulder = (geometry(shoulder + step, elbow)[0] - geometry(shoulder - step, elbow)[0]) / (2 * step)
    by_elbow = (geometry(shoulder, elbow + step)[0] - geometry(shoulder, elbow - step)[0]) / (2 * step)
    np.testing.assert_allclose(moment_arm, -np.stack([by_shoulder, by_elbow], axis=1), atol=1e-7)


def test_length_is_the_sum_of_the_splines_of_the_file():
    q = np.array([0.3, 1.1])
    length, _ = geometry(*q)
    expected = [
        sum(BSpline(*term.spline)(q[ARM.coordinates.index(term.coordinate)]) for term in muscle.path)
        for muscle in ARM.muscles
    ]
    np.testing.assert_allclose(length, expected, atol=1e-15)


def test_moment_arm_is_constant_outside_the_knots():
    np.testing.assert_array_equal(geometry(2.5, 2.4)[1], geometry(2.9, 3.0)[1])


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 9])
def test_splines_of_any_degree_and_knots(degree):
    rng = np.random.default_rng(degree)
    inner = np.sort(rng.uniform(-1.0, 1.0, 4))
    knots = np.concatenate([[-1.0] * (degree + 1), inner, [1.0] * (degree + 1)])
    spline = BSpline(knots, rng.standard_normal(len(knots) - degree - 1), degree)
    table = make_path_table([(0, 0, Spline(*spline.tck))])
    length, moment_arm, curvature = np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1, 1))
    for q in np.linspace(-1.0, 1.0, 37)[1:-1]:
        evaluate_paths(np.array([q]), table, length, moment_arm)
        evaluate_path_curvatures(np.array([q]), table, curvature)
        np.testing.assert_allclose(length[0], spline(q), rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(moment_arm[0, 0], -spline(q, nu=1), rtol=1e-7, atol=1e-7)
        if degree > 1:
            np.testing.assert_allclose(curvature[0, 0, 0], spline(q, nu=2), rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("lanes", [1, 7])
def test_many_arms_have_the_paths_of_each_arm_alone(lanes):
    """Lengths and slopes agree while the arms change pieces of the splines and leave the range of the knots."""
    rng = np.random.default_rng(0)
    paths = ARM.path_table
    pieces = make_path_pieces(paths, lanes)
    length, slope = np.empty((14, lanes)), np.empty((count_slopes(paths), lanes))
    for _ in range(100):
        q = rng.uniform(-3.0, 3.0, (2, lanes))
        evaluate_path_lanes(q, paths, pieces, length, slope)
        for k in range(lanes):
            expected, moment_arm = geometry(*q[:, k])
            np.testing.assert_allclose(length[:, k], expected, atol=1e-15)
            assert slope[:, k].sum() == pytest.approx(-moment_arm.sum(), abs=1e-15)


def test_known_lengths_and_moment_arms():
    """The hanging arm, in m: OpenSim 4.6 gives 0.27761, 0.42458, 0.14735 for the lengths."""
    length, moment_arm = geometry(0.0, 0.0)
    names = ARM.muscle_names
    assert length[names.index("TRIlong")] == pytest.approx(0.27761, abs=6e-3)  # its shoulder path is smoothed
    assert length[names.index("BRA")] == pytest.approx(0.14735, abs=1e-4)
    assert moment_arm[names.index("BIClong"), 0] > 0.0  # lifts the upper arm
    assert (moment_arm[[names.index(n) for n in ("BIClong", "BICshort", "BRD")], 1] > 0.0).all()
    assert (moment_arm[[names.index(n) for n in ("TRIlong", "TRIlat", "TRImed", "ANC")], 1] < 0.0).all()


def test_paths_against_opensim(oracle):
    """In the fitted range, moment arms differ from OpenSim's by at most 1.4 mm (table: docs/validation.md)."""
    grid = oracle("paths_grid.npz")
    rounding = 1e-9
    rows = np.flatnonzero(np.abs(grid["shoulder"] - np.deg2rad(22.5)) <= np.deg2rad(82.5) + rounding)
    columns = np.flatnonzero(np.abs(grid["elbow"] - np.deg2rad(65)) <= np.deg2rad(65) + rounding)
    ours = [[geometry(grid["shoulder"][i], grid["elbow"][j]) for j in columns] for i in rows]
    length = np.abs(
        np.array([[g[0] for g in row] for row in ours]) - np.moveaxis(grid["length"], 0, -1)[rows][:, columns]
    )
    theirs = np.moveaxis(grid["moment_arm"], 0, -2)[rows][:, columns]
    moment_arm = np.abs(np.array([[g[1] for g in row] for row in ours]) - theirs)
    print("largest errors in mm: length, shoulder and elbow moment arm")
    for i, name in enumerate(ARM.muscle_names):
        shoulder, elbow = 1e3 * moment_arm[..., i, :].max(axis=(0, 1))
        print(f"| {name} | {1e3 * length[..., i].max():.2f} | {shoulder:.2f} | {elbow:.2f} |")
    assert moment_arm.max() < 1.4e-3
