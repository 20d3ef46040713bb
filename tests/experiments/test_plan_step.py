"""What planning a scenario leaves in the run folder."""

from dataclasses import asdict

import pytest

from drakearm.experiments import RunFolder, plan_step


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
    kept = run.read_json("plan", "plan")
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
