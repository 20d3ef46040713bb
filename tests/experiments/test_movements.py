"""The shipped movements: reaches go where their names say, and every scenario has a plan."""

import numpy as np
import pytest
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drakearm.diagrams import MakeStaticLoop
from drakearm.experiments import load_scenario, scenario_files
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.planning import plan
from drakearm.planning.feasibility import muscle_feasibility
from tests.shipped import PAPER

REACHES = [name for name in scenario_files() if name.startswith("reach-")]
TIMINGS = [name for name in scenario_files() if name.startswith("timing-")]


def hand_path(arm, angles: np.ndarray) -> np.ndarray:
    """Where the tip of the limb is (N, 3), m, at joint angles (N, n_q)."""
    plant = MakeTorqueArm(arm)
    context = plant.CreateDefaultContext()
    points = []
    for q in angles:
        plant.SetPositions(context, q)
        points.append(plant.GetFrameByName(arm.tip_frame).CalcPoseInWorld(context).translation())
    return np.array(points)


def test_eight_reaches_are_shipped():
    assert REACHES == [f"reach-{direction:03d}" for direction in range(0, 360, 45)]


@pytest.mark.parametrize("name", REACHES)
def test_reach_moves_the_hand_10_cm_in_its_direction(arm, name):
    movement = load_scenario(name).movement
    angle = np.deg2rad(float(name.removeprefix("reach-")))
    start, target = hand_path(arm, [movement.start, movement.target])
    np.testing.assert_allclose(np.rad2deg(movement.start), [-20.0, 80.0])
    way = (target - start)[:2]  # in the sagittal plane: forward and up
    np.testing.assert_allclose(way, 0.1 * np.array([np.cos(angle), np.sin(angle)]), atol=1e-4)


def end_of_simulation(arm, scenario, found) -> tuple[np.ndarray, np.ndarray]:
    """Where a plan's torques bring the plant itself, simulated at tight accuracy: q and v, each (n_q,)."""
    builder = DiagramBuilder()
    limit = np.array(scenario.movement.torque_limit)
    plant = builder.AddSystem(MakeTorqueArm(arm, scenario.load_mass, torque_limit=limit))
    source = builder.AddSystem(TrajectorySource(PiecewisePolynomial.FirstOrderHold(found.t, found.tau.T)))
    builder.Connect(source.get_output_port(), plant.get_actuation_input_port())
    simulator = Simulator(builder.Build())
    ResetIntegratorFromFlags(simulator, "runge_kutta3", 0.01).set_target_accuracy(1e-8)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetPositions(context, scenario.movement.start)
    simulator.AdvanceTo(found.t[-1])
    return plant.GetPositions(context), plant.GetVelocities(context)


def test_the_24_movements_of_the_paper_are_shipped():
    assert len(PAPER) == 24


@pytest.mark.slow
@pytest.mark.parametrize("name", scenario_files())
def test_every_shipped_scenario_has_a_plan_that_the_plant_carries_out(name):
    scenario = load_scenario(name)
    arm = load_arm(scenario.arm)
    found = plan(arm, scenario.movement, scenario.load_mass, scenario.obstacle)
    reference = found.reference
    np.testing.assert_allclose(reference.q[-1], scenario.movement.target, atol=1e-6)
    q, v = end_of_simulation(arm, scenario, found)
    np.testing.assert_allclose(q, scenario.movement.target, atol=1e-3)
    np.testing.assert_allclose(v, 0.0, atol=0.01)
    assert found.verification.angle_margin > -1e-3 and found.verification.torque_margin > 0.0
    hand = hand_path(arm, reference.q)
    speed = np.linalg.norm(np.diff(hand, axis=0), axis=1)
    if name in REACHES:  # in one bell, along a line that is nearly straight
        peak = int(np.argmax(speed))
        moving = slice(peak, round(scenario.movement.duration / 0.01))
        assert np.all(np.diff(speed[:peak]) > -1e-5) and np.all(np.diff(speed[moving]) < 1e-5)
        way = hand[-1] - hand[0]
        aside = np.linalg.norm(np.cross(hand - hand[0], way), axis=1) / np.linalg.norm(way)
        assert aside.max() < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("name", [*REACHES, *TIMINGS, "lift-1kg", "lift-2kg", "obstacle"])
def test_static_optimization_tracks_what_the_muscles_can_do(name):
    scenario = load_scenario(name)
    arm = load_arm(scenario.arm)
    found = plan(arm, scenario.movement, scenario.load_mass, scenario.obstacle)
    assert muscle_feasibility(arm, found.reference, scenario.load_mass).feasible
    recording = MakeStaticLoop(scenario.task(found.reference)).Run()
    error = np.abs(recording.q - recording.reference_q)
    assert np.all(error.mean(axis=0) < 0.05)


@pytest.mark.parametrize("name", ["lift-5kg", "lift-10kg", "lift-20kg"])
def test_heavy_loads_are_beyond_the_shoulder(name):
    """At (0, 90) deg the arm holds 2.5 kg at most: its only useful shoulder flexor is the biceps."""
    scenario = load_scenario(name)
    arm = load_arm(scenario.arm)
    found = plan(arm, scenario.movement, scenario.load_mass)
    feasibility = muscle_feasibility(arm, found.reference, scenario.load_mass)
    assert not feasibility.feasible and "the shoulder lacks" in feasibility.verdict
