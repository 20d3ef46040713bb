"""`drakearm new-limb`: the limb that it writes is short, loads, and runs from a plan to its evaluation."""

import json

import pytest
import yaml

from drakearm.experiments import load_scenario
from drakearm.experiments.limb_template import write_limb_template
from drakearm.model.loader import load_limb
from tests.cli.command import drakearm


@pytest.fixture
def folder(tmp_path):
    write_limb_template(tmp_path / "limb")
    return tmp_path / "limb"


def test_writes_a_limb_that_can_be_inspected(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    printed = drakearm("new-limb", "new/limb")
    assert "muscles.yaml, reach.yaml, skeleton.urdf" in printed and "drakearm run new/limb/reach.yaml" in printed
    table = " ".join(drakearm("inspect", "new/limb").split())
    assert "flexor, extensor: path functions that are fitted to the points, with errors of at most" in table
    assert "flexor, extensor: slack lengths with which the fibers are optimal at elbow 66°" in table


def test_the_muscles_take_at_most_25_lines(folder):
    lines = [line for line in (folder / "muscles.yaml").read_text().splitlines() if line.split("#")[0].strip()]
    assert len(lines) <= 25


def test_fits_are_good_and_fibers_work_near_their_optimum(folder):
    limb = load_limb(folder)
    assert all(fit.is_good for fit in limb.fitted.values())


def test_earlier_files_are_kept(folder):
    (folder / "muscles.yaml").write_text("mine")
    assert "muscles.yaml exists already: expected another folder" in drakearm("new-limb", folder, code=1)
    assert (folder / "muscles.yaml").read_text() == "mine"


@pytest.mark.slow
def test_its_movement_is_planned_learned_and_evaluated(folder, tmp_path):
    fields = yaml.safe_load((folder / "reach.yaml").read_text())
    fields["training"] = {"batches": 2, "environments": 8, "minibatches": 2, "epochs": 2, "imitation_rounds": 2}
    (folder / "reach.yaml").write_text(yaml.safe_dump(fields))
    assert load_scenario(folder / "reach.yaml").arm == str(folder.resolve() / ".")
    drakearm("run", folder / "reach.yaml", "--out", tmp_path / "run")
    assert "metrics.json" in {file.name for file in (tmp_path / "run").iterdir()}
    assert json.loads((tmp_path / "run" / "plan.json").read_text())["feasibility"]["feasible"]
