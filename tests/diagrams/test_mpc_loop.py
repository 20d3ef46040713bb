"""Model predictive control follows the plan, brings a pushed arm back, and shows its prediction at a port."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.trajectories import PiecewisePolynomial

from drakearm.diagrams import MakeMpcLoop
from drakearm.errors import PlanningError
from drakearm.experiments.scenario import load_scenario
from drakearm.planning import Movement, PlanningModel, Posture, RecedingHorizon, Torque, plan

MOVEMENT = load_scenario("timing-0.7s").movement
HORIZON = 1.6  # s


def push(at: float, torque: list[float]) -> PiecewisePolynomial:
    """A torque (n_q,), Nm, on the joints for 50 ms. at: its start (s)."""
    breaks = [0.0, at, at + 0.05, 10.0]
    return PiecewisePolynomial.ZeroOrderHold(breaks, np.array([[0, 0], torque, [0, 0], [0, 0]], dtype=float).T)


@pytest.fixture(scope="module")
def model(arm):
    return PlanningModel(arm)


def test_without_disturbance_it_carries_out_the_plan(arm):
    once, again = plan(arm, MOVEMENT), plan(arm, MOVEMENT, horizon=HORIZON)
    np.testing.assert_allclose(again.reference.t, once.reference.t, atol=1e-9)
    np.testing.assert_allclose(again.reference.q, once.reference.q, atol=0.01)
    np.testing.assert_allclose(again.reference.q[-1], MOVEMENT.target, atol=1e-3)
    assert again.status == "18 solutions found"
    assert sum(again.costs.values()) == pytest.approx(sum(once.costs.values()), rel=0.05)


def test_it_keeps_clear_of_an_obstacle(arm):
    scenario = load_scenario("obstacle")
    found = plan(arm, scenario.movement, obstacle=scenario.obstacle, horizon=HORIZON)
    assert found.verification.clearance > 0.005
    np.testing.assert_allclose(found.reference.q[-1], scenario.movement.target, atol=1e-3)


@pytest.mark.parametrize("at", [0.1, 0.35, 0.62, 1.0])
@pytest.mark.parametrize("torque", [[2.0, 2.0], [-2.0, 2.0]])
def test_a_pushed_arm_comes_back(arm, model, at, torque):
    planner = RecedingHorizon(model, MOVEMENT, HORIZON)
    pushed = MakeMpcLoop(arm, planner, disturbance=push(at, torque)).Run(MOVEMENT.start, 1.6)
    during = round(at / 0.01) + 6
    undisturbed = plan(arm, MOVEMENT).reference.q
    planned = undisturbed[min(during, len(undisturbed) - 1)]
    assert np.abs(pushed.q[during] - planned).max() > 0.02  # the push had an effect
    np.testing.assert_allclose(pushed.q[-1], MOVEMENT.target, atol=0.005)
    np.testing.assert_allclose(pushed.v[-1], 0.0, atol=0.01)


def test_costs_pull_a_free_end_to_the_target(arm, model):
    costs = [Posture(running=100.0, running_speed=1.0), Torque(weight=0.01)]
    free = Movement(
        start_deg=(0, 0), target_deg=(0, 45), duration=0.8, end="free", hold=0.0, speed_limit=(15, 15),
        torque_limit=(60, 60), costs=costs,
    )  # fmt: skip
    found = plan(arm, free, horizon=0.6)
    assert np.abs(found.reference.q[-1] - free.target).max() < 0.1


def test_the_prediction_can_be_read_from_its_port(arm, model):
    loop = MakeMpcLoop(arm, RecedingHorizon(model, MOVEMENT, HORIZON))
    simulator = Simulator(loop.diagram)
    simulator.AdvanceTo(0.06)
    context = loop.controller.GetMyContextFromRoot(simulator.get_context())
    predicted = loop.controller.GetOutputPort("predicted_state").Eval(context)
    assert isinstance(predicted, PiecewisePolynomial)
    assert (predicted.start_time(), predicted.end_time()) == (pytest.approx(0.04), pytest.approx(0.7))
    now = loop.plant.get_state_output_port().Eval(loop.plant.GetMyContextFromRoot(simulator.get_context()))
    np.testing.assert_allclose(predicted.value(0.06).ravel(), now, atol=2e-3)


def test_before_the_first_plan_there_is_no_torque_and_no_prediction(arm, model):
    controller = MakeMpcLoop(arm, RecedingHorizon(model, MOVEMENT, HORIZON)).controller
    context = controller.CreateDefaultContext()
    np.testing.assert_array_equal(controller.GetOutputPort("torque").Eval(context), 0.0)
    predicted = controller.GetOutputPort("predicted_state").Eval(context)
    assert isinstance(predicted, PiecewisePolynomial)
    assert predicted.get_number_of_segments() == 0


@pytest.mark.parametrize(
    ("changes", "horizon", "message"),
    [
        ({}, 0.1, r"horizon is 0.1 s: expected at least 0.4 s"),
        ({}, float("nan"), "horizon is nan s: expected"),
        ({}, float("inf"), "horizon is inf s: expected"),
        ({}, 1e9, r"horizon is 1e\+09 s: expected at least 0.4 s and at most 10 s"),
        ({"duration": (0.5, 0.7)}, 1.0, "duration is free"),
    ],
)
def test_unusable_horizons_are_refused(arm, changes, horizon, message):
    with pytest.raises(PlanningError, match=message):
        plan(arm, replace(MOVEMENT, **changes), horizon=horizon)
