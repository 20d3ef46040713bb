"""Movements that are valid but extreme: each ends soon with a plan of finite numbers or with one sentence."""

import time
from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import PlanningError
from drakearm.experiments import load_scenario
from drakearm.model import load_arm
from drakearm.planning import CostPiece, Duration, HandPosition, HeldJoint, Posture, TorqueRate, plan
from drakearm.planning import collocation as collocation_module

LONGEST = 20.0  # s of processor time


@pytest.fixture
def movement():
    return load_scenario("timing-0.7s").movement


@pytest.mark.parametrize(
    "changes",
    [
        {"duration": 0.01, "hold": 0.0},
        {"duration": 60.0, "hold": 60.0},
        {"duration": (0.01, 60.0)},
        {"duration": (0.01, 0.05), "knots": 60},
        {"knots": 200, "duration": 0.15},
        {"costs": [Posture(running=1e12), TorqueRate(weight=1e-300)]},
        {"costs": [Posture(final=1e-300)]},
        {"costs": [HeldJoint(joint="elbow", angle_deg=540, weight=1e12), Duration(weight=1e12)]},
        {"costs": [HandPosition(position=(None, 1e12, None), final=1e300 * 1e-290)]},
        {"torque_limit": (1e12, 1e12), "speed_limit": (1e12, 1e-12)},
        {"torque_limit": (1e12, 1e12), "speed_limit": (1e12, 1e12), "duration": 0.01},
        {"target_deg": (0, 500)},
        {"angle_limit_deg": ((1, -1), (0, 100))},
    ],
    ids=str,
)
def test_an_extreme_movement_has_a_plan_or_a_reason(movement, changes):
    arm = load_arm("arm14")
    plan(arm, movement)  # compiles
    began = time.thread_time()
    try:
        found = plan(arm, replace(movement, **changes))
    except PlanningError as error:
        assert len(str(error)) <= 300
    else:
        assert found.reference.problem() is None
        assert np.isfinite(list(found.costs.values())).all()
    assert time.thread_time() - began < LONGEST


class Endless(CostPiece):
    """A cost whose minimum cannot be found: it differs from one evaluation to the next."""

    type = "endless"

    def add(self, problem):
        rng = np.random.default_rng(0)

        def cost(x):
            return rng.normal(size=1), rng.normal(size=(1, len(x)))

        return [problem.add_cost(cost, problem.q(k)) for k in range(len(problem.times))]


class Breaks(CostPiece):
    """A cost that is not finite away from the guess."""

    type = "breaks"

    def add(self, problem):
        evaluations = iter(range(1000))

        def cost(x):
            return np.array([1.0 if next(evaluations) < 40 else np.nan]), np.ones((1, len(x)))

        return [problem.add_cost(cost, problem.q(3))]


@pytest.mark.parametrize(
    ("cost", "sentence"), [(Endless(), "found none in 0.5 s|the solver stopped"), (Breaks(), "no plan")]
)
def test_a_solver_that_fails_or_does_not_end_is_stopped(movement, monkeypatch, cost, sentence):
    monkeypatch.setattr(collocation_module, "_LONGEST", 0.5)
    with pytest.raises(PlanningError, match=sentence):
        plan(load_arm("arm14"), replace(movement, costs=[*movement.costs, cost]))
