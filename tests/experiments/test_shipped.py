"""The shipped policies: one per shipped scenario, each as good as its metrics say."""

import json

import numpy as np
import pytest

from drakearm.experiments import adopt_step, load_scenario, run_metrics, run_policy, scenario_files, shipped_run
from drakearm.experiments.run_folder import RunFolder
from drakearm.learning import Policy
from drakearm.model import load_arm
from drakearm.planning import plan


def test_every_shipped_scenario_has_a_policy():
    assert [name for name in scenario_files() if shipped_run(name) is None] == []


@pytest.mark.parametrize("name", scenario_files())
def test_a_shipped_policy_is_as_good_as_its_metrics_say(name):
    shipped, scenario = shipped_run(name), load_scenario(name)
    expected = json.loads(shipped.path("metrics").read_text())
    training = json.loads(shipped.path("training").read_text())
    planned = plan(load_arm(scenario.arm), scenario.movement, scenario.load_mass, scenario.obstacle)
    task = scenario.task(planned.reference)
    policy = Policy.load(shipped.path("policy"))
    found = run_metrics(task, run_policy(task, policy), scenario.success)
    assert training["finished"] and policy.metadata["scenario"] == name == expected["scenario"]
    assert policy.metadata["seed"] == training["seed"] == expected["seed"]
    for quantity, value in expected["noise_free"].items():
        if quantity != "success":
            np.testing.assert_allclose(found[quantity], value, rtol=0.05, atol=2e-3, err_msg=quantity)


def test_a_scenario_of_a_user_has_no_shipped_policy(tmp_path):
    own = tmp_path / "timing-0.4s.yaml"
    own.write_text(scenario_files()["timing-0.4s"].read_text())
    assert shipped_run(own) is None
    assert shipped_run(scenario_files()["timing-0.4s"]) is not None


def test_a_run_with_a_shipped_policy_is_a_complete_one(tmp_path):
    run = RunFolder(tmp_path / "run")
    adopt_step(run, "timing-0.4s", shipped_run("timing-0.4s"))
    assert Policy.load(run.existing("policy", "train")).metadata["scenario"] == "timing-0.4s"
    assert run.holds_plan_of("timing-0.4s")
    assert run.read_json("training", "train")["finished"]
