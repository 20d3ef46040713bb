"""Ctrl-C while a policy is trained: what was learned is kept, and the command says so."""

import json
import re
import signal
from functools import partial

import pytest
import yaml

from drakearm.experiments import RunFolder, plan_step, train_step
from drakearm.learning import Policy
from tests.cli.command import drakearm, start

# A shell may start the tests with SIGINT ignored, and processes inherit that.
_listen = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)


def interrupted(scenario, out, after, *arguments):
    """What a training prints that is interrupted after a line which starts like this, and its exit code."""
    process = start("train", scenario, "--out", out, *arguments, preexec_fn=_listen)
    for line in process.stdout:
        if line.startswith(after):
            process.send_signal(signal.SIGINT)
            break
    printed, errors = process.communicate(timeout=300)
    assert "stopping after this batch" in errors and "Traceback" not in errors
    return printed, process.returncode


def test_interrupted_training_keeps_the_policy_and_exits_with_130(tiny, tmp_path):
    drakearm("plan", tiny, "--out", tmp_path)
    printed, code = interrupted(tiny, tmp_path, "training 10 of", "--batches", 1_000_000)
    assert code == 130
    found = re.search(r"interrupted at (\d+) of 1000000 batches, policy kept", printed)
    assert found and int(found[1]) >= 10
    assert Policy.load(tmp_path / "policy.safetensors").metadata["scenario"] == "tiny"
    training = json.loads((tmp_path / "training.json").read_text())
    assert training["steps"] == 300 * int(found[1]) and not training["finished"]


def test_training_interrupted_before_the_first_batch_says_that_there_is_no_policy(tiny, tmp_path):
    fields = yaml.safe_load(open(tiny).read())
    fields["training"]["imitation_rounds"] = 1_000_000
    slow = tmp_path / "slow.yaml"
    slow.write_text(yaml.safe_dump(fields))
    drakearm("plan", slow, "--out", tmp_path)
    printed, code = interrupted(slow, tmp_path, "training: imitated")
    assert code == 130
    assert "interrupted before the first batch was done: no policy was written" in printed
    assert not (tmp_path / "policy.safetensors").exists()


def test_interrupted_training_leaves_a_policy_that_can_be_evaluated(tiny, tmp_path):
    run = RunFolder(tmp_path)
    plan_step(run, tiny)

    def interrupt(report):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train_step(run, seed=0, on_batch=interrupt)
    drakearm("evaluate", tiny, "--out", tmp_path)
    assert json.loads((tmp_path / "metrics.json").read_text())["training_steps"] == 300
    assert not json.loads((tmp_path / "training.json").read_text())["finished"]
