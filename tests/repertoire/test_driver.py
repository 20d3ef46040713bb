"""What drives the muscles in a movement, by its name, and movements that are planned anew."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import PlanningError, PolicyFileError
from drakearm.experiments import load_scenario
from drakearm.experiments.catalog import POLICIES
from drakearm.learning import Policy
from drakearm.repertoire import load_repertoire
from drakearm.repertoire.driver import find_driver, scenario_of_policy
from drakearm.repertoire.planned import PlannedMovement

LIFT = POLICIES / "lift-1kg" / "policy.safetensors"


@pytest.fixture(scope="module")
def lift():
    return PlannedMovement.of_scenario(load_scenario("lift-1kg"))


@pytest.mark.parametrize(
    ("name", "of", "all_movements"),
    [
        ("static", "static optimization", True),
        ("reaching", "policy reaching", True),
        (str(POLICIES / "reaching-delayed" / "policy.safetensors"), "policy reaching-delayed", True),
        (str(LIFT), "policy lift-1kg", False),
    ],
)
def test_each_driver_makes_the_movement(lift, name, of, all_movements):
    driver = find_driver(name)
    assert driver.name == of and driver.makes_all_movements == all_movements
    shown = driver.record(lift, "lift")
    assert shown.load_mass == 1.0 and shown.caption.title == "lift"
    assert np.abs(shown.recording.q - lift.task.reference.q).mean() < 0.05
    assert not shown.caption.failed


def test_what_is_no_driver_is_refused(lift, tmp_path):
    with pytest.raises(PolicyFileError, match=r"expected a file with the ending .safetensors, or one of static"):
        find_driver("dancing")
    with pytest.raises(PolicyFileError, match="There is no policy file"):
        find_driver("none.safetensors")
    other = replace(lift, task=replace(lift.task, arm=replace(lift.task.arm, name="other")))
    with pytest.raises(PolicyFileError, match="is not for the arm other of lift-1kg"):
        find_driver("reaching").loop(other)


def test_a_policy_names_its_scenario(tmp_path):
    policy = Policy.load(LIFT)
    assert scenario_of_policy(LIFT, policy) == "lift-1kg"
    policy.metadata["scenario"] = "mine"
    with pytest.raises(PolicyFileError, match=r"has no scenario.yaml beside it.*--policy FILE"):
        scenario_of_policy(tmp_path / "policy.safetensors", policy)
    (tmp_path / "scenario.yaml").touch()
    assert scenario_of_policy(tmp_path / "policy.safetensors", policy) == tmp_path / "scenario.yaml"


def test_another_load_or_target_is_planned_anew(lift):
    heavier = lift.changed(None, 1.5)
    assert heavier.task.load_mass == 1.5 and heavier.movement == lift.movement
    np.testing.assert_allclose(heavier.task.reference.q[-1], lift.task.reference.q[-1], atol=1e-6)
    elsewhere = lift.changed((0.25, 0.4), 0.0)
    recorded = find_driver("reaching").record(elsewhere, "elsewhere").recording
    np.testing.assert_allclose(recorded.p_WH[-1, :2], (0.25, 0.4), atol=0.01)
    np.testing.assert_allclose(recorded.q[0], lift.task.reference.q[0], atol=1e-6)
    for to, load_mass in (((2.0, 0.4), 0.0), (None, 30.0)):
        with pytest.raises(PlanningError):
            lift.changed(to, load_mass)


def test_a_repertoire_shows_a_reach():
    planned = PlannedMovement.of_repertoire(load_repertoire("reaching"))
    recorded = find_driver("reaching").record(planned, "reach").recording
    np.testing.assert_allclose(recorded.p_WH[-1, :2], (0.4, 0.6), atol=0.01)
