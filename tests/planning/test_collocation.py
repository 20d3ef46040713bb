"""Plans: they keep to their ends and limits, are right for the plant, and fail with a reason."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drakearm.errors import PlanningError
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.model.points import point_positions
from drakearm.model.reference import CONTROL_STEP
from drakearm.model.skeleton import gravity_torque, movement_torques
from drakearm.planning import (
    Duration,
    HandPosition,
    HeldJoint,
    Movement,
    PlanningModel,
    Posture,
    Torque,
    TorqueRate,
    plan,
)

ARM = load_arm("arm14")
TIMING = Movement(
    start_deg=(0, 0),
    target_deg=(0, 90),
    duration=0.7,
    speed_limit=(15, 15),
    torque_limit=(60, 60),
    costs=[
        Posture(running=0.1),
        TorqueRate(weight=0.1),
        HeldJoint(joint="shoulder", angle_deg=0, weight=1000),
    ],
)
SHORT = replace(TIMING, duration=0.4, knots=21)


@pytest.fixture(scope="module")
def timing():
    return plan(ARM, TIMING)


def test_starts_and_ends_at_rest_in_equilibrium(timing):
    reference = timing.reference
    plant = MakeTorqueArm(ARM)
    end = round(TIMING.duration / CONTROL_STEP)
    for k, q in ((0, TIMING.start), (end, TIMING.target), (-1, TIMING.target)):
        np.testing.assert_allclose(reference.q[k], q, atol=1e-6)
        np.testing.assert_allclose(reference.v[k], 0.0, atol=1e-6)
        np.testing.assert_allclose(reference.a[k], 0.0, atol=1e-4)
        np.testing.assert_allclose(reference.tau[k], gravity_torque(plant, q), atol=1e-5)


def test_reference_is_sampled_at_control_steps_and_includes_the_hold(timing):
    steps = round((TIMING.duration + TIMING.hold) / CONTROL_STEP)
    np.testing.assert_allclose(timing.reference.t, CONTROL_STEP * np.arange(steps + 1))
    assert {getattr(timing.reference, name).shape for name in ("q", "v", "a", "tau")} == {(steps + 1, 2)}


def test_reference_satisfies_the_equations_of_motion(timing):
    r = timing.reference
    torques = movement_torques(MakeTorqueArm(ARM), r.q, r.v, r.a)
    np.testing.assert_allclose(torques, r.tau, atol=1e-8)
    np.testing.assert_allclose(np.gradient(r.q[:, 1], r.t)[1:-1], r.v[1:-1, 1], atol=0.01)


def test_timing_holds_the_upper_arm_and_bends_the_elbow_in_one_bell(timing):
    r = timing.reference
    assert np.max(np.abs(r.q[:, 0])) < 0.01
    speed = r.v[: round(TIMING.duration / CONTROL_STEP) + 1, 1]
    peak = int(np.argmax(speed))
    assert 0.35 < r.t[peak] / TIMING.duration < 0.65
    assert np.all(np.diff(speed[: peak + 1]) > 0) and np.all(np.diff(speed[peak:]) < 0)


@pytest.mark.parametrize(("movement", "load_mass"), [(TIMING, 0.0), (SHORT, 0.0), (TIMING, 5.0)])
def test_torques_hold_on_the_plant(movement, load_mass):
    """The plan comes from equations derived from the plant; the test uses the plant itself."""
    found = plan(ARM, movement, load_mass)
    builder = DiagramBuilder()
    plant = builder.AddSystem(MakeTorqueArm(ARM, load_mass, torque_limit=np.array(movement.torque_limit)))
    torque = PiecewisePolynomial.FirstOrderHold(found.t, found.tau.T)
    source = builder.AddSystem(TrajectorySource(torque))
    builder.Connect(source.get_output_port(), plant.get_actuation_input_port())
    simulator = Simulator(builder.Build())
    ResetIntegratorFromFlags(simulator, "runge_kutta3", 0.01).set_target_accuracy(1e-8)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetPositions(context, movement.start)
    simulator.AdvanceTo(movement.duration)
    np.testing.assert_allclose(plant.GetPositions(context), movement.target, atol=0.01)
    np.testing.assert_allclose(plant.GetVelocities(context), 0.0, atol=0.1)


def test_binding_limits_are_met():
    free = plan(ARM, SHORT)
    limited = replace(SHORT, speed_limit=(15, 6.5), torque_limit=(8.8, 60))
    tight = plan(ARM, limited)
    assert np.max(np.abs(free.v[:, 1])) > 6.5 and np.max(np.abs(free.tau[:, 0])) > 8.8
    assert np.all(np.abs(tight.v) <= np.array(limited.speed_limit) + 1e-5)
    assert np.all(np.abs(tight.tau) <= np.array(limited.torque_limit) + 1e-5)
    assert np.min(tight.reference.q[:, 1]) > -1e-3  # the elbow's joint limit, between the knots
    assert sum(tight.costs.values()) > sum(free.costs.values())


def test_a_heavier_weight_holds_the_joint_better():
    posture, rate, held = SHORT.costs
    excursions = []
    for weight in (10.0, 100.0, 1000.0):
        movement = replace(SHORT, costs=[posture, rate, replace(held, weight=weight)])
        excursions.append(np.max(np.abs(plan(ARM, movement).q[:, 0])))
    assert excursions[0] > 2 * excursions[1] > 4 * excursions[2]


def test_only_the_ratio_of_the_weights_matters():
    costs = [Posture(running=1e-3), TorqueRate(weight=1e-3)]
    larger = [Posture(running=1e2), TorqueRate(weight=1e2)]
    first, second = (plan(ARM, replace(SHORT, costs=c)) for c in (costs, larger))
    np.testing.assert_allclose(first.q, second.q, atol=1e-5)
    assert second.costs["posture"] == pytest.approx(1e5 * first.costs["posture"])


def test_a_load_takes_more_torque():
    unloaded, loaded = (plan(ARM, SHORT, load_mass=mass) for mass in (0.0, 5.0))
    assert np.max(np.abs(loaded.tau)) > 2.0 * np.max(np.abs(unloaded.tau))


def test_the_same_call_gives_the_same_plan():
    first, second = plan(ARM, SHORT), plan(ARM, SHORT)
    assert first.status == second.status == "solution found"
    assert first.costs == second.costs
    np.testing.assert_array_equal(first.reference.q, second.reference.q)
    np.testing.assert_array_equal(first.reference.tau, second.reference.tau)


def test_a_hand_position_draws_the_free_end_there():
    goal = (0.25, 0.45, None)
    costs = [HandPosition(position=goal, final=1e4), Posture(final_speed=1.0), TorqueRate(weight=0.01)]
    found = plan(ARM, replace(SHORT, end="free", hold=0.0, costs=costs))
    tip = point_positions(found.q[-1], PlanningModel(ARM).tip)[0][0]
    np.testing.assert_allclose(tip[:2], goal[:2], atol=5e-3)
    assert np.abs(found.q[-1] - SHORT.target).max() > 0.1  # not where the movement's target is


def test_own_angle_limits_are_met():
    limited = plan(ARM, replace(SHORT, angle_limit_deg=((-0.2, 0.2), (0, 90))))
    assert np.abs(limited.q[:, 0]).max() <= np.deg2rad(0.2) + 1e-6
    assert limited.q[:, 1].max() <= np.pi / 2 + 1e-6


def test_a_free_duration_is_that_of_least_cost():
    movement = replace(SHORT, duration=(0.3, 0.8), costs=[*SHORT.costs, Duration(weight=2.0)])
    best = plan(ARM, movement)
    steps = round(best.t[-1] / CONTROL_STEP)
    assert 31 <= steps <= 79 and best.t[-1] == pytest.approx(steps * CONTROL_STEP)

    def cost(duration):
        return sum(plan(ARM, replace(movement, duration=duration)).costs.values())

    least = sum(best.costs.values())
    assert least <= cost(round(best.t[-1] + 0.03, 2)) and least <= cost(round(best.t[-1] - 0.03, 2))


def test_a_free_duration_avoids_the_impossible():
    found = plan(ARM, replace(SHORT, duration=(0.1, 0.6), costs=[Torque(weight=1.0), Duration(weight=1e5)]))
    assert 0.1 < found.t[-1] < 0.3  # as short as the torque limits allow


def test_verification_tells_a_good_plan_from_a_bad_one(timing):
    good = timing.verification
    assert good.speed_defect < 2e-3 and good.acceleration_defect < 0.05
    coarse = plan(ARM, replace(TIMING, knots=6)).verification
    assert coarse.acceleration_defect > 20 * good.acceleration_defect


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"start_deg": (0, -5)}, r"start has the elbow at -5 deg.*joint limits, 0 to 130 deg"),
        ({"target_deg": (190, 90)}, r"target has the shoulder at 190 deg.*joint limits"),
        ({"start_deg": (0, 0, 0)}, r"start_deg has 3 values: expected 2, for shoulder, elbow"),
        ({"torque_limit": (60,)}, r"torque_limit has 1 values: expected 2"),
        ({"torque_limit": (60, 1)}, r"rest at the target.*torque limit of the elbow, 1 Nm"),
        ({"speed_limit": (15, 3)}, r"exceeds the speed limit of the elbow by [\d.]+ rad/s at 0"),
        (
            {"duration": 0.2, "torque_limit": (9, 60)},
            r"exceeds the torque limit of the shoulder by",
        ),
        ({"duration": 0.1}, r"exceeds .*torque limit of the shoulder by"),
    ],
)
def test_failure_names_what_stands_in_the_way(changes, message):
    with pytest.raises(PlanningError, match=message):
        plan(ARM, replace(SHORT, **changes))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"duration": 0.705}, "whole number of control steps"),
        ({"duration": -1}, "duration"),
        ({"knots": 2}, "knots"),
        ({"speed_limit": (0, 15)}, "speed_limit"),
        ({"costs": []}, "costs"),
        ({"duration": (0.5, 0.4)}, "a shortest duration and a longer one"),
        ({"end": "free"}, "hold: expected 0"),
    ],
)
def test_a_movement_checks_its_fields(changes, message):
    with pytest.raises(ValidationError, match=message):
        replace(TIMING, **changes)
