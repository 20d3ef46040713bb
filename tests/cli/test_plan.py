"""`drakearm plan`: what it prints and keeps of one plan, and of many of which some fail."""

import re

import pytest
import yaml

from drakearm.experiments import scenario_files
from drakearm.model.reference import Reference
from tests.cli.command import drakearm, start


def plan(*arguments, code=0):
    """What `drakearm plan` prints, or the sentence of its error."""
    return drakearm("plan", *arguments, code=code)


def written(folder, name, **movement):
    """The file of a scenario like timing-0.7s with another name and movement."""
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    fields["movement"] |= movement
    file = folder / f"{name}.yaml"
    file.write_text(yaml.safe_dump({**fields, "name": name}))
    return file


def test_one_plan_prints_its_facts(tmp_path):
    printed = plan("timing-0.7s", "--out", tmp_path)
    for part in (
        "Gauss-Newton",
        "solution found",
        "iterations",
        "held_joint",
        "torque_rate",
        "rad/s",
        "Nm",
        "can do it",
    ):
        assert part in printed, part
    assert "clearance" not in printed
    assert {file.name for file in tmp_path.iterdir()} == {"scenario.yaml", "reference.npz", "plan.json", "plan.png"}


def test_where_one_fails_the_others_are_planned(tmp_path):
    hasty = written(tmp_path, "hasty", duration=0.1)
    printed = plan(hasty, "reach-090", "--out", tmp_path / "runs", code=1)
    assert "1 of 2 movements planned" in printed
    assert re.search("hasty +no plan", printed) and "hasty: There is no plan from (0, 0) deg" in printed
    assert "can, up to 0.1" in printed
    assert Reference.load(tmp_path / "runs" / "reach-090" / "reference.npz").duration == 0.75
    assert not list((tmp_path / "runs" / "hasty").iterdir())
    assert "planning 1 of 2: hasty, no plan" in printed  # a line for each, where there is no terminal
    assert "planning 2 of 2: reach-090, solution found" in printed


def test_several_are_not_planned_where_one_would_be_overwritten(tmp_path):
    plan("reach-090", "--out", tmp_path / "reach-090")
    assert "reach-090/reference.npz exists already" in plan("reach-000", "reach-090", "--out", tmp_path, code=1)
    assert not (tmp_path / "reach-000" / "plan.json").exists()


def test_a_failing_plan_leaves_the_earlier_one(tmp_path):
    plan(written(tmp_path, "mine"), "--out", tmp_path / "run")
    before = {file.name: file.read_bytes() for file in (tmp_path / "run").iterdir()}
    hasty = written(tmp_path, "mine", duration=0.1)
    assert "There is no plan" in plan(hasty, "--out", tmp_path / "run", "--overwrite", code=1)
    assert {file.name: file.read_bytes() for file in (tmp_path / "run").iterdir()} == before


def test_two_scenarios_of_one_name_are_refused(tmp_path):
    (tmp_path / "other").mkdir()
    files = written(tmp_path, "mine"), written(tmp_path / "other", "mine")
    assert "both named mine" in plan(*files, "--out", tmp_path / "runs", code=1)


@pytest.mark.slow
@pytest.mark.extra
def test_plan_all_plans_every_shipped_scenario(tmp_path):
    printed = plan("all", "--out", tmp_path)
    summary = f"{len(scenario_files())} of {len(scenario_files())} movements planned"
    table = printed[printed.index(summary) :]
    rows = [line.split()[0] for line in table.splitlines() if "solution found" in line]
    assert rows == list(scenario_files())
    for name in scenario_files():
        assert (tmp_path / name / "plan.png").is_file()
    assert rows.index("lift-2kg") < rows.index("lift-10kg")


def test_every_problem_of_a_file_has_a_line(tmp_path):
    file = written(tmp_path, "wrong", hold=-1.0, speed="fast", knots=2)
    process = start("plan", file)
    _, errors = process.communicate()
    assert process.returncode == 1
    first, *others = errors.splitlines()
    assert first.startswith(f"error: {file}: movement.") and first.endswith("(and 2 more problems).")
    assert len(others) == 2 and all(line.startswith("       movement.") and line.endswith(".") for line in others)
