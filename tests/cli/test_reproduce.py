"""`drakearm reproduce`: its arguments, and that a killed reproduction is completed."""

import os
import signal
import time

import pytest

from drakearm.reproduction.catalog import EXPERIMENTS
from drakearm.reproduction.trial import Method
from tests.cli.command import drakearm, start
from tests.reproduction.small import BATCHES, Small, results, write_scenario

METHODS = (Method.static, Method.default)
OWN = """
from drakearm.reproduction.catalog import EXPERIMENTS
from tests.reproduction.small import Small

EXPERIMENTS["small"] = Small({file!r}, methods=("static optimization", "default"))
"""


@pytest.fixture(scope="module")
def scenario(tmp_path_factory):
    return write_scenario(tmp_path_factory.mktemp("scenario") / "small.yaml")


@pytest.fixture
def registered(scenario, monkeypatch):
    monkeypatch.setitem(EXPERIMENTS, "small", Small(scenario, methods=METHODS))


def test_wrong_arguments_are_refused():
    wrong = {
        ("timin",): "did you mean timing",
        ("timing", "--seeds", 0): "expected a whole number from 1 to 1000",
        ("timing", "--jobs", "many"): "expected a whole number from 1 to",
        ("timing", "--backend", "slurm"): "'dask', 'ray'",
        ("timing", "--out", ""): "expected a path",
    }
    for arguments, expected in wrong.items():
        printed = drakearm("reproduce", *arguments, code=2)
        assert expected in " ".join(printed.replace("│", " ").split())


def stop(signal_number, file, *arguments):
    """Starts the command in a process group of its own, and stops it when a file exists. Returns code and output.

    A shell lets what it starts in the background ignore Ctrl-C, so the command must get back the default.
    """
    process = start(*arguments, start_new_session=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    while not file.exists() and process.poll() is None:
        time.sleep(0.02)
    if signal_number == signal.SIGINT:
        os.killpg(process.pid, signal_number)  # as a terminal does it
    else:
        process.send_signal(signal_number)
    output, errors = process.communicate()
    return process.returncode, output + errors


@pytest.mark.slow
@pytest.mark.extra
@pytest.mark.usefixtures("registered")
def test_a_stopped_reproduction_is_completed(scenario, tmp_path):
    small = ("reproduce", "small", "--batches", BATCHES)
    drakearm(*small, "--out", tmp_path / "whole", "--jobs", 1)
    own = tmp_path / "own.py"
    own.write_text(OWN.format(file=str(scenario)))
    stopped = (*small, "--out", tmp_path / "stopped")
    trials = tmp_path / "stopped" / "trials" / "small"

    begun = trials / "default" / "seed-0" / "training.json"  # from the first batch on
    code, printed = stop(signal.SIGINT, begun, *stopped, "--import", own)
    assert code == 130 and "the same command continues" in printed and "Traceback" not in printed
    evaluated = trials / "default" / "seed-0" / "metrics.json"
    assert stop(signal.SIGKILL, evaluated, *stopped, "--import", own, "--jobs", 1)[0] == -signal.SIGKILL
    printed = drakearm(*stopped, "--jobs", 1)
    assert "report.html in a browser" in printed
    assert results(tmp_path / "stopped") == results(tmp_path / "whole")

    refused = drakearm("reproduce", "small", "--out", tmp_path / "stopped", "--batches", BATCHES + 1, code=1)
    assert "was made with other settings" in refused and "--overwrite" in refused
