"""`drakearm train A B` and `drakearm evaluate A B`: one policy for several scenarios, and one table of its errors."""

import json
from pathlib import Path

import pytest
import yaml

from drakearm.experiments import RunFolder
from drakearm.figures import evaluations_table
from tests.cli.command import drakearm


@pytest.fixture(scope="module")
def two(tiny, tmp_path_factory):
    """The files of two scenarios."""
    fields = yaml.safe_load(open(tiny).read())
    fields["training"]["imitation_rounds"] = 1
    files = []
    for name, target_deg in (("right", [0, 90]), ("half", [0, 45])):
        fields |= {"name": name, "movement": fields["movement"] | {"target_deg": target_deg}}
        files.append(tmp_path_factory.mktemp("scenario") / f"{name}.yaml")
        files[-1].write_text(yaml.safe_dump(fields))
    return files


@pytest.fixture(scope="module")
def learned(two, tmp_path_factory):
    """The folder of the runs, of which one was planned before, and what the training printed."""
    out = tmp_path_factory.mktemp("runs")
    drakearm("plan", two[0], "--out", out / "right")
    return out, drakearm("train", *two, "--out", out, "--seed", 3)


def test_what_is_not_planned_yet_is_planned_and_each_run_gets_the_policy(learned):
    out, printed = learned
    assert "planned half: solution found" in printed and "planned right" not in printed
    assert "training 2 of 2: error 0." in printed and "one policy for 2 movements" in printed
    for name in ("right", "half"):
        assert str(out / name / "policy.safetensors") in printed.replace("\n", "")
        training = RunFolder(out / name).read_json("training", "train")
        assert [scenario["name"] for scenario in training["scenarios"]] == ["right", "half"]


def test_one_table_has_the_errors_of_all(learned, two):
    out, _ = learned
    printed = drakearm("evaluate", *two, "--out", out)
    assert "evaluating 0 of 2: right" in printed and "evaluating 1 of 2: half" in printed
    evaluations = [json.loads((out / name / "metrics.json").read_text()) for name in ("right", "half")]
    columns = evaluations_table(evaluations).columns
    assert [str(cell) for cell in columns[0].cells] == ["right", "half"]
    for metrics, cell in zip(evaluations, columns[1].cells, strict=True):
        assert float(cell) == pytest.approx(max(metrics["noise_free"]["tracking_error_mean"]), rel=0.01)
        assert cell in printed
    assert "exists already" in drakearm("evaluate", *two, "--out", out, code=1)


def test_one_run_is_used_by_itself(learned, two):
    out, _ = learned
    assert "right, seed 3" in drakearm("evaluate", two[0], "--out", out / "right", "--overwrite")
    assert "replay.html" in drakearm("replay", two[0], "--out", out / "right")


def test_perturbed_runs_of_all_are_measured(learned, two):
    out, _ = learned
    printed = drakearm("evaluate", *two, "--out", out, "--load", 1)
    for name in ("right", "half"):
        assert f"results in {out / name / 'perturbed.json'}" in printed


def test_the_training_is_continued_only_with_all(learned, two):
    out, _ = learned
    assert "finished already" in drakearm("train", *two, "--out", out, "--seed", 3, "--resume")
    alone = ("train", two[0], "--out", out / "right", "--seed", 3)
    assert "another list of plans (right, half)" in drakearm(*alone, "--resume", code=1)
    assert "another list of plans (right, half)" in drakearm(
        "train", *reversed(two), "--out", out, "--seed", 3, "--resume", code=1
    )
    assert "exists already" in drakearm(*alone, code=1)


def test_runs_have_the_names_of_the_scenarios(two, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    drakearm("train", *two, two[0], "--batches", 1)
    assert sorted(folder.name for folder in (tmp_path / "runs").iterdir()) == ["half", "right"]
    copy = tmp_path / "copy.yaml"
    copy.write_text(two[0].read_text())
    assert "both named right" in drakearm("train", two[0], copy, code=1)


@pytest.mark.slow
@pytest.mark.extra
def test_the_example_of_the_documentation_works(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")
    commands = page.partition("## One policy for several scenarios")[2].split("```")[1].strip().splitlines()
    assert len(commands) == 3
    for command in commands:
        program, step, *arguments = command.split()
        assert program == "drakearm"
        drakearm(step, *arguments, *(["--batches", 1] if step == "train" else []))
    assert (tmp_path / "runs" / "three" / "reach-090" / "replay.html").exists()
