"""`drakearm reproduce`: its arguments, and that a killed reproduction is completed."""

import os
import signal
import time

import pytest

from drakearm.reproduction.catalog import EXPERIMENTS
from tests.cli.command import drakearm, start
from tests.reproduction.small import BATCHES, Small, results, write_scenario

OWN = """
from drakearm.reproduction.catalog import EXPERIMENTS
from tests.reproduction.small import Small

EXPERIMENTS["small"] = Small({file!r})
"""


@pytest.fixture(scope="module")
def scenario(tmp_path_factory):
    return write_scenario(tmp_path_factory.mktemp("scenario") / "small.yaml")


@pytest.fixture
def small(scenario, monkeypatch):
    monkeypatch.setitem(EXPERIMENTS, "small", Small(scenario))


def test_wrong_arguments_are_refused():
    assert "did you mean timing" in drakearm("reproduce", "timin", code=2)
    assert "from 1 to 1000" in drakearm("reproduce", "timing", "--seeds", 0, code=2)
    assert "dask" in drakearm("reproduce", "timing", "--backend", "slurm", code=2)
    assert "expected a path" in drakearm("reproduce", "timing", "--out", "", code=2)


def stop(signal_number, file, *arguments):
    """Starts the command in a process group of its own, and stops it when a file exists. Returns code and output."""
    process = start(*arguments, start_new_session=True)
    while not file.exists() and process.poll() is None:
        time.sleep(0.02)
    if signal_number == signal.SIGINT:
        os.killpg(process.pid, signal_number)  # as a terminal does it
    else:
        process.send_signal(signal_number)
    output, errors = process.communicate()
    return process.returncode, output + errors


@pytest.mark.slow
def test_a_stopped_reproduction_is_completed(small, scenario, tmp_path):
    drakearm("reproduce", "small", "--out", tmp_path / "whole", "--jobs", 1)
    own = tmp_path / "own.py"
    own.write_text(OWN.format(file=str(scenario)))
    command = ("reproduce", "small", "--out", tmp_path / "stopped", "--import", own)
    trials = tmp_path / "stopped" / "trials" / "small"

    code, printed = stop(signal.SIGINT, trials / "ppo_alone" / "seed-0" / "checkpoint.safetensors", *command)
    assert code == 130 and "the same command continues" in printed and "Traceback" not in printed
    kill = (signal.SIGKILL, trials / "default" / "seed-0" / "metrics.json", *command, "--jobs", 1)
    assert stop(*kill)[0] == -signal.SIGKILL
    printed = drakearm("reproduce", "small", "--out", tmp_path / "stopped", "--jobs", 1)
    assert "1 of 3 trials were finished already" in printed and "report.html in a browser" in printed
    assert results(tmp_path / "stopped") == results(tmp_path / "whole")

    refused = drakearm("reproduce", "small", "--out", tmp_path / "stopped", "--batches", BATCHES + 1, code=1)
    assert "was made with other settings" in refused and "--overwrite" in refused
