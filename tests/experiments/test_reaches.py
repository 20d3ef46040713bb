"""The shipped movements: reaches go where their names say, and every scenario has a plan."""

import numpy as np
import pytest

from drakearm.diagrams import MakeTorqueArm
from drakearm.experiments.scenario import load_scenario, scenario_files
from drakearm.model import load_arm
from drakearm.planning import plan

REACHES = [name for name in scenario_files() if name.startswith("reach-")]


def hand_path(arm, angles: np.ndarray) -> np.ndarray:
    """Where the tip of the hand is (N, 3), m, at joint angles (N, n_q)."""
    plant = MakeTorqueArm(arm)
    context = plant.CreateDefaultContext()
    points = []
    for q in angles:
        plant.SetPositions(context, q)
        points.append(plant.GetFrameByName("hand_tip").CalcPoseInWorld(context).translation())
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


@pytest.mark.slow
@pytest.mark.parametrize("name", scenario_files())
def test_every_shipped_scenario_has_a_plan(name):
    scenario = load_scenario(name)
    arm = load_arm(scenario.arm)
    reference = plan(arm, scenario.movement, scenario.load_mass, scenario.obstacle).reference
    np.testing.assert_allclose(reference.q[-1], scenario.movement.target, atol=1e-6)
    hand = hand_path(arm, reference.q)
    speed = np.linalg.norm(np.diff(hand, axis=0), axis=1)
    if name in REACHES:  # in one bell, along a line that is nearly straight
        peak = int(np.argmax(speed))
        moving = slice(peak, round(scenario.movement.duration / 0.01))
        assert np.all(np.diff(speed[:peak]) > -1e-5) and np.all(np.diff(speed[moving]) < 1e-5)
        way = hand[-1] - hand[0]
        aside = np.linalg.norm(np.cross(hand - hand[0], way), axis=1) / np.linalg.norm(way)
        assert aside.max() < 0.01
