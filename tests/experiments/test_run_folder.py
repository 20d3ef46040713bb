"""Whether a run folder holds a plan of a scenario."""

import shutil

import pytest
import yaml

from drakearm.experiments import Preset, RunFolder, plan_step, scenario_files
from drakearm.model import load_arm


@pytest.fixture
def scenario(tmp_path):
    """The file of a scenario with an arm of its own."""
    shutil.copytree(load_arm("arm14").skeleton.parent, tmp_path / "lab" / "limb")
    fields = yaml.safe_load(scenario_files()["reach-000"].read_text())
    file = tmp_path / "lab" / "mine.yaml"
    file.write_text(yaml.safe_dump(fields | {"name": "mine", "arm": "limb"}))
    return file


@pytest.fixture
def run(tmp_path, scenario):
    run = RunFolder(tmp_path / "run")
    plan_step(run, scenario)
    return run


def test_a_plan_of_the_same_scenario_is_recognized(run, scenario):
    assert run.holds_plan_of(scenario)
    assert run.holds_plan_of(run.path("scenario"))
    assert run.holds_plan_of(scenario, Preset.drakearm)  # the default
    scenario.write_text("# a comment changes nothing\n" + scenario.read_text())
    assert run.holds_plan_of(scenario)


def test_another_preset_is_another_scenario(run, scenario):
    assert not run.holds_plan_of(scenario, Preset.paper)


def test_another_field_is_another_scenario(run, scenario):
    scenario.write_text(yaml.safe_dump(yaml.safe_load(scenario.read_text()) | {"load_mass": 1.0}))
    assert not run.holds_plan_of(scenario)


def test_another_arm_is_another_scenario(run, scenario):
    muscles = scenario.parent / "limb" / "muscles.yaml"
    muscles.write_text(muscles.read_text() + "\n# changed\n")
    assert not run.holds_plan_of(scenario)
    scenario.write_text(yaml.safe_dump(yaml.safe_load(scenario.read_text()) | {"arm": "arm14"}))
    assert not run.holds_plan_of(scenario)


def test_a_folder_without_a_plan_holds_none(run, scenario):
    run.path("reference").unlink()
    assert not run.holds_plan_of(scenario)
