"""The option `--import`: costs of a user's own on the command line."""

import json
import shutil
import sys
from pathlib import Path

import pytest
import yaml

from drakearm.experiments import scenario_files
from tests.cli.command import drakearm, start

OWN_COST = Path(__file__).parents[2] / "examples" / "own_cost.py"  # defines the cost `power`


@pytest.fixture
def scenario(tmp_path):
    """The file of a movement whose costs include `power`."""
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    fields["movement"]["costs"].append({"type": "power", "weight": 0.01})
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump({**fields, "name": "mine"}))
    return file


def costs(out):
    return set(json.loads((out / "plan.json").read_text())["costs"])


def finish(*arguments, **options):
    """The exit code of the command in a process of its own, and what it printed on stderr."""
    process = start(*arguments, **options)
    _, errors = process.communicate()
    return process.returncode, errors


def refusal(*arguments):
    """The sentence with which `drakearm plan` refuses what --import names."""
    return drakearm("plan", "timing-0.7s", *arguments, code=1)


# Costs are imported in processes of their own: in one process, a type belongs to the module that defined it first.


def test_a_cost_from_a_file(scenario, tmp_path):
    assert finish("plan", scenario, "--out", tmp_path / "run", "--import", OWN_COST) == (0, "")
    assert costs(tmp_path / "run") == {"held_joint", "torque_rate", "posture", "power"}


def test_a_cost_from_a_module_in_the_current_folder(scenario, tmp_path):
    shutil.copy(OWN_COST, tmp_path / "my_costs.py")
    assert finish("plan", "mine.yaml", "--import", "my_costs", cwd=tmp_path) == (0, "")
    assert "power" in costs(tmp_path / "runs" / "mine")


def test_each_command_of_the_run_needs_the_import(scenario, tmp_path):
    shutil.copy(OWN_COST, tmp_path / "my_costs.py")
    run = ("mine.yaml", "--out", "run")
    assert finish("plan", *run, "--import", "my_costs", cwd=tmp_path) == (0, "")
    code, errors = finish("train", *run, "--batches", 1, cwd=tmp_path)
    assert code == 1
    assert "found 'power', expected one of duration" in errors and "Traceback" not in errors
    assert finish("train", *run, "--batches", 1, "--import", "my_costs", cwd=tmp_path) == (0, "")


def test_a_module_that_does_not_exist_is_named():
    assert "no module 'my_csots'" in refusal("--import", "my_csots")
    assert "no module 'my_csots'" in refusal("--import", "my_csots.power")


def test_a_file_that_does_not_exist_is_named(tmp_path):
    assert "there is no such file" in refusal("--import", tmp_path / "my_costs.py")


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("x = 1\nraise ValueError('too heavy')", "line 2: ValueError: too heavy"),
        ("import no_such_module", "line 1: ModuleNotFoundError: No module named 'no_such_module'"),
        ("def f(:", "line 1: SyntaxError"),
        ("import sys\nsys.exit(3)", "line 2: SystemExit: 3"),
    ],
)
def test_code_that_fails_is_one_sentence_with_its_line(tmp_path, code, told):
    file = tmp_path / "broken.py"
    file.write_text(code)
    sentence = refusal("--import", file)
    assert str(file) in sentence and told in sentence
    assert "\n" not in sentence


def test_a_file_does_not_hide_a_module_of_the_same_name(tmp_path):
    file = tmp_path / "json.py"
    file.write_text("raise ImportError('found')")
    assert "ImportError: found" in refusal("--import", file)
    assert sys.modules["json"] is json
