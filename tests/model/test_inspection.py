"""The results of an inspection agree with the arm's splines and with the equilibria of its muscles."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.optimize import brentq

from drakearm.errors import EquilibriumError
from drakearm.model import Arm
from drakearm.model.inspection import inspect_arm, joint_ranges
from drakearm.model.musculature import RESTING_ACTIVATION, equilibrium_fiber_lengths


def with_muscles(arm: Arm, **changes) -> Arm:
    return replace(arm, muscles=tuple(replace(m, **changes) for m in arm.muscles))


def with_tendon_slack_length(arm: Arm, name: str, scale: float) -> Arm:
    muscles = (
        replace(m, tendon_slack_length=m.tendon_slack_length * (scale if m.name == name else 1.0)) for m in arm.muscles
    )
    return replace(arm, muscles=tuple(muscles))


def muscle(inspection, name):
    return next(m for m in inspection.muscles if m.muscle.name == name)


@pytest.fixture(scope="module")
def inspection(arm):
    return inspect_arm(arm)


def test_joint_ranges_are_those_of_the_skeleton_file(arm):
    ranges = {name: np.rad2deg([r.lower, r.upper]) for name, r in joint_ranges(arm).items()}
    np.testing.assert_allclose(ranges["shoulder"], [-90, 180], atol=1e-4)
    np.testing.assert_allclose(ranges["elbow"], [0, 130], atol=1e-4)


def test_the_range_of_a_joint_without_limits_is_one_turn(arm, tmp_path):
    skeleton = tmp_path / "skeleton.urdf"
    urdf = arm.skeleton.read_text().replace(
        '<joint name="shoulder" type="revolute">', '<joint name="shoulder" type="continuous">'
    )
    skeleton.write_text(urdf.replace('lower="-1.57079633" upper="3.14159265" ', ""))
    shoulder = joint_ranges(replace(arm, skeleton=skeleton))["shoulder"]
    assert (shoulder.lower, shoulder.upper) == (-np.pi, np.pi)


def test_lengths_and_moment_arms_are_those_of_the_splines(inspection):
    """The splines continue along their tangents, so the extremes of the slope lie inside the knots."""
    for inspected in inspection.muscles:
        splines = {term.coordinate: BSpline(*term.spline) for term in inspected.muscle.path}
        assert [c.coordinate for c in inspected.crossings] == [c for c in inspection.ranges if c in splines]
        for crossing in inspected.crossings:
            joint, spline = inspection.ranges[crossing.coordinate], splines[crossing.coordinate]
            inside = np.clip(np.linspace(joint.lower, joint.upper, 5001), crossing.fitted.lower, crossing.fitted.upper)
            moment_arms = -spline(inside, nu=1)
            found = crossing.moment_arm_range
            np.testing.assert_allclose([found.lower, found.upper], [moment_arms.min(), moment_arms.max()], atol=5e-5)
            others = sum(s(0.0) for name, s in splines.items() if name != crossing.coordinate)
            fitted = (crossing.q >= crossing.fitted.lower) & (crossing.q <= crossing.fitted.upper)
            np.testing.assert_allclose(crossing.length[fitted], spline(crossing.q[fitted]) + others, atol=1e-12)


def test_extremes_over_the_other_joints_enclose_every_length(arm, inspection):
    biceps = muscle(inspection, "BIClong")
    shoulder, elbow = biceps.crossings
    assert np.all(shoulder.shortest <= shoulder.length) and np.all(shoulder.length <= shoulder.longest)
    assert shoulder.shortest.min() == pytest.approx(elbow.shortest.min(), abs=1e-12)
    brachialis = muscle(inspection, "BRA")
    np.testing.assert_allclose(brachialis.crossings[0].shortest, brachialis.crossings[0].length, atol=1e-15)


def test_working_ranges_are_the_equilibria_over_all_joint_angles(arm, inspection):
    grid = [np.linspace(r.lower, r.upper, 28) for r in inspection.ranges.values()]
    activation = np.full(len(arm.muscles), RESTING_ACTIVATION)
    optimal = np.array([m.optimal_fiber_length for m in arm.muscles])
    fibers = [
        equilibrium_fiber_lengths(arm, np.array([[shoulder, elbow]]), activation)[0] / optimal
        for shoulder in grid[0]
        for elbow in grid[1]
    ]
    for inspected, lower, upper in zip(inspection.muscles, np.min(fibers, 0), np.max(fibers, 0), strict=True):
        working = inspected.working
        assert working.slack == {}
        assert working.fiber_length.lower == pytest.approx(lower, abs=5e-3)
        assert working.fiber_length.upper == pytest.approx(upper, abs=5e-3)
        assert 0.1 < working.fiber_length.lower < working.fiber_length.upper < 1.8
        assert 0.0 < working.tendon_strain.lower < working.tendon_strain.upper < 0.1


def test_angles_without_equilibrium_are_reported(arm):
    longer = with_tendon_slack_length(arm, "BIClong", 1.25)
    working = muscle(inspect_arm(longer), "BIClong").working
    assert 0.0 < working.fiber_length.lower < 0.02  # as short as fibers get
    shoulder, elbow = working.slack["shoulder"], working.slack["elbow"]
    activation = np.full(len(arm.muscles), RESTING_ACTIVATION)
    with pytest.raises(EquilibriumError, match="BIClong"):
        equilibrium_fiber_lengths(longer, np.array([[shoulder.upper, elbow.upper]]), activation)
    splines = {term.coordinate: BSpline(*term.spline) for term in muscle(inspect_arm(longer), "BIClong").muscle.path}
    shortest = min(splines["shoulder"](np.linspace(0.0, 1.8, 2001)))
    edge = brentq(lambda q: splines["elbow"](q) + shortest - working.shortest_path, 0.0, 2.26)
    assert elbow.lower == pytest.approx(edge, abs=np.deg2rad(1.0))


def test_a_muscle_that_is_slack_everywhere_has_no_working_range(arm):
    working = muscle(inspect_arm(with_tendon_slack_length(arm, "FCU", 1.5)), "FCU").working
    assert working.fiber_length is None and working.tendon_strain is None
    assert (working.slack["elbow"].lower, working.slack["elbow"].upper) == pytest.approx((0.0, np.deg2rad(130)))


def test_a_fiber_on_a_rigid_tendon_takes_the_rest_of_the_path(arm):
    inspected = muscle(inspect_arm(with_muscles(arm, tendon="rigid")), "TRIlat")
    m, crossing = inspected.muscle, inspected.crossings[0]
    fiber = np.hypot(crossing.length - m.tendon_slack_length, m.fiber_width) / m.optimal_fiber_length
    found = inspected.working.fiber_length
    np.testing.assert_allclose([found.lower, found.upper], [fiber.min(), fiber.max()], atol=1e-4)
    assert inspected.working.tendon_strain.upper == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("model", ["thelen2003", "degroote2016"])
def test_curves_pass_through_their_known_points(arm, model):
    inspected = inspect_arm(with_muscles(arm, model=model)).muscles[0]
    curves, m = inspected.curves, inspected.muscle

    def at(x, y, x0):
        return float(np.interp(x0, x, y))

    assert at(curves.fiber_length, curves.active, 1.0) == pytest.approx(1.0, abs=0.01)
    assert at(curves.fiber_length, curves.passive, 1.0 + m.passive_strain) == pytest.approx(1.0, abs=0.01)
    assert at(curves.strain, curves.tendon, m.tendon_strain) == pytest.approx(1.0, abs=0.01)
    assert at(curves.velocity, curves.force, 0.0) == pytest.approx(1.0, abs=0.01)
    assert curves.velocity[0] == -m.max_contraction_velocity and curves.force[0] == pytest.approx(0.0, abs=0.01)
