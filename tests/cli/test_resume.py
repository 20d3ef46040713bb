"""A training that is stopped and continued ends as if it had not been stopped."""

import json
import random
import signal
import subprocess

import pytest
import yaml

from drakearm.experiments import RunFolder
from tests.cli.command import drakearm, start

BATCHES = 30


@pytest.fixture(scope="module")
def quick(tiny, tmp_path_factory):
    """A scenario like tiny that imitates only once."""
    fields = yaml.safe_load(open(tiny).read())
    fields["training"] |= {"batches": BATCHES, "imitation_rounds": 1}
    file = tmp_path_factory.mktemp("scenario") / "quick.yaml"
    file.write_text(yaml.safe_dump(fields))
    return file


@pytest.fixture(scope="module")
def whole(quick, tmp_path_factory):
    """A run that was never stopped."""
    run = RunFolder(tmp_path_factory.mktemp("whole"))
    drakearm("plan", quick, "--out", run.folder)
    drakearm("train", quick, "--out", run.folder)
    return run


def kill_after(line, *arguments):
    """Starts a command and kills it as soon as it has printed a line that begins like this."""
    process = start(*arguments)
    for printed in process.stdout:
        if printed.startswith(line):
            process.send_signal(signal.SIGKILL)
            break
    process.communicate()
    return process.returncode


def test_a_killed_training_is_continued(whole, quick, tmp_path):
    run = RunFolder(tmp_path)
    drakearm("plan", quick, "--out", tmp_path)
    training = ("train", quick, "--out", tmp_path, "--resume")
    assert kill_after("training 10 of", *training) == -signal.SIGKILL
    assert run.path("checkpoint").exists()
    printed = drakearm(*training)
    assert "continuing the training after" in printed and "training 30 of 30" in printed
    assert run.path("policy").read_bytes() == whole.path("policy").read_bytes()
    assert not run.path("checkpoint").exists()
    rows = run.path("training_log").read_text().splitlines()
    assert [row.split(",")[0] for row in rows[1:]] == [str(batch) for batch in range(1, BATCHES + 1)]
    assert run.read_json("training", "train")["steps"] == whole.read_json("training", "train")["steps"]
    assert "the training is finished already" in drakearm(*training)


def test_run_continues_by_itself(quick, tmp_path):
    run = ("run", quick, "--out", tmp_path / "run")
    assert kill_after("training 10 of", *run) == -signal.SIGKILL
    printed = drakearm(*run)
    assert "continuing with the plan" in printed and "continuing the training after" in printed
    assert json.loads((tmp_path / "run" / "metrics.json").read_text())["training_steps"] == 300 * BATCHES
    assert "exists already" in drakearm(*run, code=1)


def test_another_setup_is_refused(quick, tmp_path):
    drakearm("plan", quick, "--out", tmp_path)
    drakearm("train", quick, "--out", tmp_path)
    assert "another seed" in drakearm("train", quick, "--out", tmp_path, "--resume", "--seed", 1, code=1)
    assert "another settings" in drakearm("train", quick, "--out", tmp_path, "--resume", "--batches", 9, code=1)
    assert "expected one of them" in drakearm("train", quick, "--resume", "--overwrite", code=2)


@pytest.mark.slow
@pytest.mark.extra
def test_kills_at_random_moments(whole, quick, tmp_path):
    chance = random.Random(2)
    drakearm("plan", quick, "--out", tmp_path)
    training = ("train", quick, "--out", tmp_path, "--resume")
    for _ in range(3):
        process = start(*training)
        try:
            process.wait(chance.uniform(3.0, 6.0))
        except subprocess.TimeoutExpired:
            process.kill()
        process.communicate()
    drakearm(*training)
    assert RunFolder(tmp_path).path("policy").read_bytes() == whole.path("policy").read_bytes()
