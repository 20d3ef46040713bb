"""The examples run, and each is short."""

import importlib.util
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.scenario import load_scenario
from drakearm.experiments.steps import plan_step
from drakearm.learning import ArmVectorEnv, PpoSettings, train
from drakearm.model.reference import Reference

EXAMPLES = Path(__file__).parents[2] / "examples"


def load(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("file", sorted(EXAMPLES.glob("*.py")), ids=lambda file: file.stem)
def test_example_is_short(file):
    assert len(file.read_text().splitlines()) < 60


def test_compose_arm(tmp_path, capsys):
    load("compose_arm").main(str(tmp_path / "arm.png"))
    assert (tmp_path / "arm.png").stat().st_size > 10_000
    assert "final angles" in capsys.readouterr().out


def test_follow_reference(capsys):
    load("follow_reference").main()
    error = float(capsys.readouterr().out.split()[2])
    assert error < 0.01


def test_policy_in_meshcat(tmp_path, capsys):
    run = RunFolder(tmp_path)
    plan_step(run, "timing-0.7s")
    task = load_scenario("timing-0.7s").task(Reference.load(run.path("reference")))
    settings = replace(PpoSettings(), batches=1, environments=2, minibatches=1, epochs=1)
    train(ArmVectorEnv(task, 2), settings, seed=0, metadata={}).save(run.path("policy"))
    load("policy_in_meshcat").main(tmp_path, realtime_rate=0.0)
    assert "http://localhost" in capsys.readouterr().out


def test_excitations_in_meshcat(capsys):
    q = load("excitations_in_meshcat").main(seconds=0.2)
    assert np.abs(q - np.deg2rad([0.0, 30.0])).max() > 0.01  # the weak excitations do not hold the posture
    assert "http://localhost" in capsys.readouterr().out


def test_figure_eight(tmp_path, capsys):
    load("figure_eight").main(str(tmp_path / "eight.png"))
    assert (tmp_path / "eight.png").stat().st_size > 10_000
    assert float(capsys.readouterr().out.split()[-4]) < 1.5  # cm, at most


def test_own_cost(capsys):
    plan = load("own_cost").main()
    printed = dict(line.split() for line in capsys.readouterr().out.splitlines())
    assert list(printed) == ["held_joint", "torque_rate", "posture", "power"]
    power = np.sum(plan.v * plan.tau, axis=1)
    assert float(printed["power"]) == pytest.approx(0.01 * np.trapezoid(power**2, plan.t), rel=0.01)


def test_push_and_recover(capsys):
    off = load("push_and_recover").main()
    assert np.abs(off).max() < 0.02
    assert len(capsys.readouterr().out.splitlines()) == 4


def test_own_task(capsys):
    settings = PpoSettings(batches=2, environments=8, minibatches=2, imitation_rounds=0)
    assert np.isfinite(load("own_task").main(settings))
    assert "observations of 59 numbers" in capsys.readouterr().out
