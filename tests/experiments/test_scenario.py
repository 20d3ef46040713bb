"""Scenario files: every shipped one is valid, and a wrong one is an error that names file and field."""

import re

import pytest
import yaml

from drakearm.errors import DrakearmError, ScenarioError, TaskError
from drakearm.experiments import Preset, load_scenario, plan_step, scenario_files
from drakearm.experiments.run_folder import RunFolder
from drakearm.learning import PAPER
from drakearm.model import load_arm


@pytest.mark.parametrize("name", scenario_files())
def test_every_shipped_scenario_is_valid_and_named_like_its_file(name):
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.description


def test_unknown_scenario_lists_the_known_ones():
    with pytest.raises(ScenarioError, match=r"no scenario 'dancing'.*timing-0\.7s"):
        load_scenario("dancing")


def refusal(tmp_path, change) -> str:
    """What is said about a scenario like timing-0.7s with a change."""
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    change(fields)
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump(fields))
    with pytest.raises(ScenarioError) as error:
        load_scenario(file)
    message = str(error.value)
    assert message.startswith(str(file)) and len(message) <= 300 and message.isprintable()
    return message


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
    message = refusal(tmp_path, change)
    for part in [str(tmp_path / "mine.yaml"), *named]:
        assert part in message


@pytest.mark.parametrize(
    ("section", "name", "value", "sentence"),
    [
        ("movement", "duration", 1e12, "duration: found 1000000000000.0, expected a number less than or equal to 60"),
        ("movement", "duration", 1e308, "expected a number less than or equal to"),
        ("movement", "duration", float("nan"), "duration: found nan"),
        ("movement", "duration", True, "duration: found True, expected a number or a list"),
        ("movement", "duration", [0.5, 0.4], "duration: found [0.5, 0.4], expected a shortest duration and a longer"),
        ("movement", "duration", {}, "duration: found {}, expected a number or a list"),
        ("movement", "hold", 61, "hold: found 61"),
        ("movement", "knots", True, "knots: found True, expected a number"),
        ("movement", "knots", 100_000, "knots: found 100000, expected a number less than or equal to 200"),
        ("movement", "knots", 7.5, "knots: found 7.5, expected a whole number"),
        ("movement", "start_deg", ["0", True], "start_deg.0: found '0', expected a number (and 1 more problem)"),
        ("movement", "start_deg", [1e9, 0], "expected a number less than or equal to 540"),
        ("movement", "torque_limit", [1e-300, 1], "torque_limit.0: found 1e-300, expected at least 1e-12"),
        (
            "movement",
            "angle_limit_deg",
            [[1, 2, 3], 5],
            "angle_limit_deg.0: found [1, 2, 3], expected at most 2 values",
        ),
        ("movement", "costs", [{"type": [[]]}], "costs.0.type: found [[]], expected one of"),
        ("movement", "costs", [{}], "costs.0.type: found None, expected one of"),
        ("movement", "costs", [1], "costs.0: found 1, expected a mapping with a type"),
        ("movement", "costs", [], "costs: found [], expected at least 1 value"),
        ("movement", "costs", "x", "costs: found 'x', expected a list"),
        ("movement", "costs", [{"type": "torque", "weight": 1}] * 1000, "expected at most 50 values"),
        ("movement", "costs", [{"type": "posture", "running": "x"}], "costs.0.posture.running: found 'x', expected a"),
        ("movement", "costs", [{"type": "hand_position", "position": [True, 1, 2]}], "position.0: found True"),
        ("movement", "end", "free", "movement.hold: expected 0 if the end is free"),
        ("tracking", "reward", 5, "tracking.reward: found 5, expected a mapping with a type"),
        ("tracking", "reward", {"position": 5}, "position: found 5, expected a list (and 2 more problems)"),
        ("tracking", "start_noise_deg", 1e6, "expected a number less than or equal to 90"),
        ("training", "batches", True, "training.batches: found True, expected a number"),
        ("training", "batches", 10**400, "training.batches: found 1000"),
        ("training", "environments", 10**6, "expected a number less than or equal to 4096"),
        ("training", "steps", 100_000, "found 64 environments and 100000 steps, expected at most 500,000 transitions"),
        ("training", "actor_layers", [10**6], "actor_layers.0: found 1000000"),
        ("training", "actor_layers", [8] * 100, "actor_layers: found [8, 8"),
        ("training", "learning_rate", "fast", "learning_rate: found 'fast', expected a number"),
        ("obstacle", "radius", True, "obstacle.radius: found True, expected a number"),
        ("obstacle", "axis", [0, 0, 0], "axis: found [0, 0, 0], expected a vector"),
        ("obstacle", "axis", [1e-200, 0, 0], "expected a vector"),
        (None, "obstacle", 5, "obstacle: found 5, expected fields with values"),
        (None, "name", "../../x", "name: found '../../x', expected a name without slashes"),
        (None, "arm", "", "arm: found '', expected at least 1 character"),
        (None, "load_mass", 1e9, "load_mass: found 1000000000.0, expected a number less than or equal to 1000"),
        (None, "success", [{"type": "joy"}], "success.0.type: found 'joy', expected one of hand_at_goal, joint_error"),
        (
            None,
            "success",
            [{"type": "joint_error", "of": "end"}],
            "success.0.joint_error.below: is missing, but req",
        ),
        (None, "success", [{"type": "no_contact"}] * 2, "found two criteria with the name no_contact"),
        (None, "preset", "x", "preset: found 'x', expected 'drakearm' or 'paper'"),
    ],
)
def test_an_unsuitable_value_is_named(tmp_path, section, name, value, sentence):
    def change(fields):
        fields["obstacle"] = {"position": [0, 1, 0], "radius": 0.1}
        fields.setdefault("training", {})
        (fields[section] if section else fields)[name] = value

    assert sentence in refusal(tmp_path, change)


@pytest.mark.parametrize("arm", ["..", "/", "arm15"])
def test_an_arm_that_does_not_exist_is_an_error(tmp_path, arm):
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump(fields | {"arm": arm}))
    with pytest.raises(DrakearmError, match=r"There is no arm"):
        load_arm(load_scenario(file).arm)


def test_a_reward_for_another_number_of_joints_is_an_error(tmp_path, reference):
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    fields["tracking"]["reward"]["velocity"] = [1]
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump(fields))
    with pytest.raises(TaskError, match="reward's velocity has 1 weights: expected 2, for shoulder, elbow"):
        load_scenario(file).task(reference)


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


def test_an_unknown_scenario_lists_whole_names_and_how_many_more_there_are():
    with pytest.raises(ScenarioError) as refused:
        load_scenario("reach")
    given = re.search(r"or one of (.*), (\d+) more, (.*)\.$", str(refused.value))
    assert given is not None
    names = [*given[1].split(", "), *given[3].split(", ")]
    assert set(names) < set(scenario_files()) and len(names) + int(given[2]) == len(scenario_files())
