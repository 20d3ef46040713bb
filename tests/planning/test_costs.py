"""Costs: their values on given knots, and how they are read from YAML."""

import numpy as np
import pytest
import yaml
from pydantic import TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass
from pydrake.planning import DirectCollocation
from pydrake.systems.framework import InputPortIndex

from drakearm.errors import PlanningError
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.model.obstacle import Obstacle
from drakearm.planning import (
    Cost,
    CostPiece,
    Duration,
    HandPosition,
    HeldJoint,
    ObstacleDistance,
    PlanningModel,
    Posture,
    Problem,
    SwitchedTarget,
    Torque,
    TorqueRate,
)
from drakearm.planning.costs import RATE_STEP

DURATION = 0.8
TARGET = np.array([0.2, 1.0])
COSTS = """
- {type: posture, running: 0.1, final: [1, 2]}
- {type: torque, weight: [0, 1]}
- {type: torque_rate, weight: 0.1}
- {type: held_joint, joint: shoulder, angle_deg: 10, weight: 1000}
- {type: switched_target, first_deg: [0, 22.5], switch_time: 0.3, weight: 10}
- {type: hand_position, position: [0.3, 0.5, null], final: 100}
- {type: obstacle_distance, weight: 10}
- {type: duration, weight: 2}
"""
OBSTACLE = Obstacle(position=(0.3, 0.3, 0.2), radius=0.03)


def make_problem(knots: int, obstacle: Obstacle | None = None) -> Problem:
    model = PlanningModel(load_arm("arm14"), obstacle=obstacle)
    step = DURATION / (knots - 1)
    context = model.system.CreateDefaultContext()
    collocation = DirectCollocation(model.system, context, knots, step, step, InputPortIndex(0))
    return Problem(collocation, model, np.linspace(0.0, DURATION, knots), TARGET)


def value(cost: CostPiece, knots: int, obstacle: Obstacle | None = None, **trajectories) -> float:
    """A cost's value on trajectories q, v, tau: functions of time (N,) that give (N, 2)."""
    problem = make_problem(knots, obstacle)
    bindings = cost.add(problem)
    problem.prog.SetInitialGuessForAllVariables(np.zeros(problem.prog.num_vars()))
    for name, trajectory in trajectories.items():
        for k, sample in enumerate(trajectory(problem.times)):
            problem.prog.SetInitialGuess(getattr(problem, name)(k), sample)
    guess = problem.prog.initial_guess()
    return sum(float(problem.prog.EvalBinding(binding, guess)[0]) for binding in bindings)


def ramp(slopes):
    return lambda times: np.outer(times, slopes)


def constant(values):
    return lambda times: np.tile(values, (len(times), 1))


@pytest.mark.parametrize("knots", [5, 17, 41])
def test_torque_rate_of_a_ramp_does_not_depend_on_the_knots(knots):
    cost = TorqueRate(weight=(0.1, 0.3))
    expected = DURATION * RATE_STEP**2 * (0.1 * 20.0**2 + 0.3 * 5.0**2)
    assert value(cost, knots, tau=ramp([20.0, -5.0])) == pytest.approx(expected)


def test_torque_rate_at_the_papers_step_is_the_papers_sum():
    knots = round(DURATION / RATE_STEP) + 1
    torques = np.random.default_rng(1).normal(size=(knots, 2))
    paper = 0.1 * np.sum(np.diff(torques, axis=0) ** 2)  # sum of du' R du
    cost = TorqueRate(weight=0.1)
    assert value(cost, knots, tau=lambda _: torques) == pytest.approx(RATE_STEP * paper)


@pytest.mark.parametrize("knots", [5, 41])
def test_running_costs_are_integrals_over_time(knots):
    torque = value(Torque(weight=(0.0, 2.0)), knots, tau=constant([7.0, 3.0]))
    assert torque == pytest.approx(2.0 * 9.0 * DURATION)
    held = HeldJoint(joint="elbow", angle_deg=90.0, weight=10.0)
    angle = value(held, knots, q=constant([5.0, np.pi / 2 + 0.1]))
    assert angle == pytest.approx(10.0 * 0.01 * DURATION)
    posture = Posture(running=3.0, running_speed=0.5)
    away = value(posture, knots, q=constant(TARGET + 0.1), v=constant([2.0, 0.0]))
    assert away == pytest.approx((3.0 * 0.02 + 0.5 * 4.0) * DURATION)


def test_final_posture_counts_the_last_knot_alone():
    cost = Posture(final=(1.0, 10.0), final_speed=2.0)
    arriving = lambda times: TARGET + np.outer(times < DURATION, [9.0, 9.0])  # noqa: E731
    assert value(cost, 9, q=arriving) == pytest.approx(0.0)
    away = value(cost, 9, q=constant(TARGET + np.array([0.1, 0.2])), v=constant([0.0, 0.5]))
    assert away == pytest.approx(0.01 + 0.4 + 0.5)


def test_switched_target_draws_to_the_first_posture_then_to_the_target():
    cost = SwitchedTarget(first_deg=(0.0, 22.5), switch_time=0.4, weight=(1.0, 2.0))
    first = np.deg2rad([0.0, 22.5])
    following = lambda times: np.where(times[:, None] < 0.4, first, TARGET)  # noqa: E731
    assert value(cost, 41, q=following) == pytest.approx(0.0)
    away = value(cost, 41, q=lambda times: following(times) + np.array([0.1, 0.2]))
    assert away == pytest.approx((0.01 + 2.0 * 0.04) * DURATION)


def test_duration_costs_what_the_movement_takes():
    assert value(Duration(weight=2.0), 5) == pytest.approx(2.0 * DURATION)


def hand(q: np.ndarray) -> np.ndarray:
    plant = MakeTorqueArm(load_arm("arm14"))
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    return plant.GetFrameByName("hand_tip").CalcPoseInWorld(context).translation()


def test_hand_costs_are_of_where_the_plant_has_the_hand():
    q = np.array([-0.3, 1.2])
    x, y, _ = hand(q)
    cost = HandPosition(position=(x + 0.03, y - 0.04, None), running=10.0, final=100.0)
    assert value(cost, 5, q=constant(q)) == pytest.approx(0.05**2 * (10.0 * DURATION + 100.0))
    distance = np.hypot(x - 0.3, y - 0.3)  # from an axis along z
    found = value(ObstacleDistance(weight=10.0), 5, OBSTACLE, q=constant(q))
    assert found == pytest.approx(10.0 * distance**2 * DURATION)


@pytest.mark.parametrize(
    ("cost", "obstacle", "message"),
    [
        (HandPosition(position=(0.9, 0.5, None)), None, r"out of reach.*no nearer than 0\.\d+ m"),
        (ObstacleDistance(weight=1.0), None, "expected a scenario with an obstacle"),
        (SwitchedTarget(first_deg=(1.0, 2.0, 3.0), switch_time=0.1, weight=1.0), None, "3 angles"),
    ],
)
def test_costs_say_what_they_lack(cost, obstacle, message):
    with pytest.raises(PlanningError, match=message):
        cost.add(make_problem(5, obstacle))


def test_a_cost_of_ones_own_is_known_to_scenario_files():
    @dataclass(frozen=True)
    class Jolt(CostPiece):
        type = "jolt"
        weight: float

        def add(self, problem):
            weight = np.array([[self.weight]])
            return [problem.prog.AddQuadraticErrorCost(weight, np.zeros(1), problem.tau(0)[:1])]

    (cost,) = TypeAdapter(list[Cost]).validate_python([{"type": "jolt", "weight": 3.0}])
    assert value(cost, 5, tau=constant([2.0, 9.0])) == pytest.approx(12.0)
    with pytest.raises(ValidationError, match=r"jolt\.wieght"):
        TypeAdapter(Cost).validate_python({"type": "jolt", "weight": 3.0, "wieght": 1.0})


def test_a_cost_of_ones_own_needs_a_type_of_its_own():
    with pytest.raises(TypeError, match=r"has the type 'torque' of drakearm\.planning\.costs\.Torque"):

        class Effort(CostPiece):
            type = "torque"


def test_costs_load_from_yaml():
    costs = TypeAdapter(list[Cost]).validate_python(yaml.safe_load(COSTS))
    assert costs == [
        Posture(running=0.1, final=(1.0, 2.0)),
        Torque(weight=(0.0, 1.0)),
        TorqueRate(weight=0.1),
        HeldJoint(joint="shoulder", angle_deg=10.0, weight=1000.0),
        SwitchedTarget(first_deg=(0.0, 22.5), switch_time=0.3, weight=10.0),
        HandPosition(position=(0.3, 0.5, None), final=100.0),
        ObstacleDistance(weight=10.0),
        Duration(weight=2.0),
    ]


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("{type: torque, weight: 1, wieght: 2}", "wieght"),
        ("{type: torques, weight: 1}", "held_joint"),
        ("{type: torque, weight: -1}", "weight"),
        ("{type: held_joint, joint: elbow, weight: 1}", "angle_deg"),
        ("{type: [[]], weight: 1}", "type: found .*held_joint"),
        ("{weight: 1}", "type: found None.*held_joint"),
        ("torque", "expected a mapping with a type.*held_joint"),
    ],
)
def test_wrong_yaml_is_refused_with_the_name_of_the_field(text, named):
    with pytest.raises(ValidationError, match=named):
        TypeAdapter(Cost).validate_python(yaml.safe_load(text))


def test_a_cost_must_fit_the_arm():
    problem = make_problem(5)
    with pytest.raises(PlanningError, match=r"wrist.*expected one of shoulder, elbow"):
        HeldJoint(joint="wrist", angle_deg=0.0, weight=1.0).add(problem)
    with pytest.raises(PlanningError, match="3 weights"):
        Torque(weight=(1.0, 2.0, 3.0)).add(problem)
