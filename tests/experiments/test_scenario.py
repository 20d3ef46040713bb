"""Scenario files: every shipped one is valid, and a wrong one is an error that names file and field."""

import pytest
import yaml

from drakearm.errors import ScenarioError
from drakearm.experiments import Preset, load_scenario, plan_step, scenario_files
from drakearm.experiments.run_folder import RunFolder
from drakearm.learning import PAPER


@pytest.mark.parametrize("name", scenario_files())
def test_every_shipped_scenario_is_valid_and_named_like_its_file(name):
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.description


def test_unknown_scenario_lists_the_known_ones():
    with pytest.raises(ScenarioError, match=r"no scenario 'dancing'.*timing-0\.7s"):
        load_scenario("dancing")


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda s: s.pop("movement"), ["movement", "required"]),
        (lambda s: s["movement"].pop("target_deg"), ["movement.target_deg", "required"]),
        (lambda s: s["tracking"].update(observation="smell"), ["tracking.observation", "paper, full"]),
        (lambda s: s.update(training={"batches": -1}), ["training.batches", "greater than 0"]),
        (lambda s: s.update(load_mass=-2), ["load_mass", "greater than or equal to 0"]),
        (lambda s: s.update(training={"optimizer": "sgd"}), ["training.optimizer"]),
    ],
)
def test_wrong_field_is_named(tmp_path, change, named):
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    change(fields)
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump(fields))
    with pytest.raises(ScenarioError) as error:
        load_scenario(file)
    for part in [str(file), *named]:
        assert part in str(error.value)


@pytest.mark.parametrize("text", ["", "just words", "a: ["])
def test_file_that_is_no_scenario(tmp_path, text):
    file = tmp_path / "mine.yaml"
    file.write_text(text)
    with pytest.raises(ScenarioError, match=r"mine\.yaml"):
        load_scenario(file)


def test_the_papers_preset_overrules_the_file(tmp_path):
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump(fields | {"preset": "paper"}))
    scenario = load_scenario(file)
    assert scenario.training == PAPER and scenario.tracking.observation == "paper"
    assert load_scenario("timing-0.7s").training.imitation_rounds > 0


def test_a_run_keeps_its_preset(tmp_path):
    run = RunFolder(tmp_path)
    plan_step(run, "timing-0.7s", preset=Preset.paper)
    assert run.scenario().training == PAPER
    plan_step(run, run.path("scenario"))
    assert run.scenario().training == PAPER
