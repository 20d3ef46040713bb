"""`drakearm plan`: what it prints and keeps of one plan, and of many of which some fail."""

import json
import re
from dataclasses import asdict

import numpy as np
import pytest
import yaml
from matplotlib.image import imread
from typer.testing import CliRunner

from drakearm import cli
from drakearm.experiments.plan_picture import draw_plan
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.scenario import scenario_files
from drakearm.experiments.side_view import SideView
from drakearm.experiments.steps import plan_step
from drakearm.model import MakeTorqueArm
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import Reference


def plan(*arguments, code=0):
    """Runs `drakearm plan` in this process and returns what it printed, or the sentence of its error."""
    try:
        result = CliRunner().invoke(cli.app, ["plan", *map(str, arguments)], catch_exceptions=False)
    except cli.DrakearmError as error:
        assert code == 1
        return str(error)
    assert result.exit_code == code, result.output
    return result.output


def written(folder, name, **movement):
    """The file of a scenario like timing-0.7s with another name and movement."""
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    fields["movement"] |= movement
    file = folder / f"{name}.yaml"
    file.write_text(yaml.safe_dump({**fields, "name": name}))
    return file


@pytest.fixture(scope="module")
def obstacle(tmp_path_factory):
    run = RunFolder(tmp_path_factory.mktemp("obstacle"))
    return run, plan_step(run, "obstacle")


@pytest.fixture(scope="module")
def lift(tmp_path_factory):
    run = RunFolder(tmp_path_factory.mktemp("lift"))
    return run, plan_step(run, "lift-20kg")


def test_plan_json_holds_costs_margins_and_the_verdict(obstacle):
    run, report = obstacle
    kept = json.loads(run.path("plan").read_text())
    assert kept["solver"] == report.plan.solver and kept["status"] == "solution found"
    assert kept["iterations"] > 0 and kept["seconds"] > 0.0 and kept["duration"] == 0.8
    assert kept["costs"] == report.plan.costs
    assert kept["verification"] == asdict(report.plan.verification)
    assert kept["verification"]["nearest_part"] == "hand" and kept["verification"]["clearance"] > 0.005
    assert kept["feasibility"]["feasible"] and kept["feasibility"]["verdict"].startswith("The muscles can do it")
    assert 0.0 < kept["feasibility"]["largest_activation"] < 1.0
    assert set(kept["feasibility"]["largest_reserve"]) == {"shoulder", "elbow"}


def test_what_the_muscles_lack_is_kept_by_joint(lift):
    feasibility = lift[0].read_json("plan", "plan")["feasibility"]
    assert not feasibility["feasible"]
    lack = feasibility["largest_reserve"]
    assert lack["shoulder"] > lack["elbow"] > 1.0
    assert f"the shoulder lacks {lack['shoulder']:.3g} Nm" in feasibility["verdict"]


def test_picture_is_a_png(obstacle, lift):
    for run, _ in (obstacle, lift):
        assert run.path("plan_picture").read_bytes().startswith(b"\x89PNG")
        assert np.std(imread(run.path("plan_picture"))[..., :3]) > 0.05  # not blank


def test_picture_draws_the_obstacle_where_it_is_and_what_the_muscles_lack(obstacle, lift):
    (circle,) = [patch for panel in draw_plan(obstacle[1]).axes for patch in panel.patches if hasattr(patch, "radius")]
    assert circle.center == pytest.approx((0.33, 0.25)) and circle.radius == 0.03
    texts = [text.get_text() for panel in draw_plan(lift[1]).axes if panel.legend_ for text in panel.legend_.texts]
    assert any(text.startswith("shoulder: the muscles lack up to 6") for text in texts)


@pytest.mark.parametrize("obstacle", [None, Obstacle(position=(0.3, 0.2, 0.1), radius=0.02, axis=(0.0, 0.0, -2.0))])
def test_side_view_is_of_forward_and_up(arm, obstacle):
    view, q = SideView(arm, obstacle), np.array([0.3, 1.2])
    plant = MakeTorqueArm(arm)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    tip = plant.GetFrameByName("hand_tip").CalcPoseInWorld(context).translation()
    np.testing.assert_allclose(view.stick(q)[-1], tip[:2], atol=1e-12)
    np.testing.assert_allclose(view.project(np.array([1.0, 2.0, 3.0])), [1.0, 2.0])
    assert [radius for _, _, radius in view.outline(q)] == [part.radius for part in arm.outline]


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
def test_plan_all_plans_every_shipped_scenario(tmp_path):
    printed = plan("all", "--out", tmp_path)
    assert "19 of 19 movements planned" in printed
    rows = [line.split()[0] for line in printed.splitlines() if "solution found" in line]
    assert rows == list(scenario_files())
    for name in scenario_files():
        assert (tmp_path / name / "plan.png").is_file()
    assert rows.index("lift-2kg") < rows.index("lift-10kg")
