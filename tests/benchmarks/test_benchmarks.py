"""Every benchmark, and every script that makes a page or picture of the documentation, runs and prints its table."""

import json
import math
import os
import re
import runpy
import shutil
import subprocess
import sys
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.browser import needs_chromium

BENCHMARKS = Path(__file__).parent
DOCS = Path(__file__).parents[2] / "docs"
SCRIPTS = [file for file in sorted(BENCHMARKS.glob("*.py")) if not file.stem.startswith("test_")]
NUMBER = re.compile(r"(?<![\w.])-?(?:\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?|nan|inf)(?![\w.])")


def run(script: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess:
    command = [sys.executable, str(script), *arguments]
    return subprocess.run(command, env=os.environ | environment, capture_output=True, text=True)


@cache
def run_quick(script: Path) -> subprocess.CompletedProcess:
    return run(script, "--quick")


def table_rows(output: str) -> list[list[str]]:
    """The cells of each row of the tables in an output, without their heads; "|" or rich's "│" separates them."""
    lines = [line.strip() for line in output.splitlines()]
    rows = [re.split("[|│]", line)[1:-1] for line in lines if line[:1] in ("|", "│")]
    cells = [[cell.strip() for cell in row] for row in rows]
    rules = [i for i, row in enumerate(cells) if all(set(cell) == {"-"} for cell in row)]  # Markdown, below the head
    return [row for i, row in enumerate(cells) if i not in rules and i + 1 not in rules]


def assert_finite_table(output: str) -> list[list[str]]:
    """The rows of the table; each has a number behind its name, and all numbers are finite."""
    rows = table_rows(output)
    assert rows, output
    for row in rows:
        numbers = [float(number.replace(",", "")) for cell in row[1:] for number in NUMBER.findall(cell)]
        assert numbers and all(map(math.isfinite, numbers)), row
    return rows


@pytest.mark.slow
@pytest.mark.extra
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_benchmark_prints_its_table(script):
    done = run_quick(script)
    assert done.returncode == 0, done.stderr
    assert_finite_table(done.stdout)
    for line in done.stdout.splitlines():
        if line.startswith("not measured"):  # a package may be missing; one that is there must work
            assert re.search("not installed|missing", line), line


@pytest.mark.slow
@pytest.mark.extra
def test_planning_compares_with_do_mpc():
    if not find_spec("do_mpc"):
        pytest.skip("do-mpc is not installed, so there is nothing to compare planning with")
    done = run_quick(BENCHMARKS / "planning.py")
    planners = [row[1] for row in table_rows(done.stdout)]
    assert planners.count("do-mpc") == planners.count("drakearm, receding horizon") == 2, done.stderr
    assert "agree" in done.stdout


def test_opensim_says_what_is_missing(tmp_path):
    """Package and model file are different things to look for; an empty package stands for one that is installed."""
    script = BENCHMARKS / "others" / "opensim_arm.py"
    model = tmp_path / "14muscles.osim"
    model.touch()
    absent, present = tmp_path / "absent", tmp_path / "present"
    for folder, text in ((absent, "raise ImportError"), (present, "")):
        folder.mkdir()
        (folder / "opensim.py").write_text(text)
    no_package = run(script, PYTHONPATH=str(absent), OPENSIM_MODEL=str(model))
    no_file = run(script, PYTHONPATH=str(present), OPENSIM_MODEL="")
    neither = run(script, PYTHONPATH=str(absent), OPENSIM_MODEL=str(tmp_path / "elsewhere.osim"))
    package, file = "OpenSim is not installed", "the model file is missing"
    assert package in no_package.stderr and file not in no_package.stderr
    assert file in no_file.stderr and package not in no_file.stderr
    assert package in neither.stderr and file in neither.stderr


@pytest.mark.slow
@pytest.mark.extra
def test_make_results_prints_its_page():
    before = (DOCS / "results.md").read_text()
    done = run_quick(DOCS / "make_results.py")
    assert done.returncode == 0, done.stderr
    assert len(assert_finite_table(done.stdout)) > 3
    assert (DOCS / "results.md").read_text() == before


def test_the_page_of_results_is_the_one_that_the_script_writes():
    script = runpy.run_path(str(DOCS / "make_results.py"))
    assert script["page"](json.loads((DOCS / "results.json").read_text())) == (DOCS / "results.md").read_text()


@pytest.mark.slow
@pytest.mark.extra
def test_make_policies_ships_a_policy():
    done = run_quick(DOCS / "make_policies.py")
    assert done.returncode == 0, done.stderr
    assert len(assert_finite_table(done.stdout)) == 1


@pytest.mark.slow
@pytest.mark.extra
@needs_chromium
def test_make_pictures_makes_a_picture():
    done = run_quick(DOCS / "make_pictures.py")
    assert done.returncode == 0, done.stderr
    assert len(assert_finite_table(done.stdout)) == 1


def test_every_drawn_diagram_is_in_the_docs():
    script = runpy.run_path(str(DOCS / "draw_diagrams.py"))
    diagrams = script["build_diagrams"]()
    assert {file.stem for file in DOCS.glob("*.svg")} == {diagram.get_name() for diagram in diagrams}
    for diagram in diagrams:
        assert "->" in script["describe"](diagram)


def test_draw_diagrams_writes_pictures(tmp_path):
    if shutil.which("dot") is None:
        pytest.skip("Graphviz, which draws the Diagrams, is not installed")
    done = run(DOCS / "draw_diagrams.py", "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert {file.name for file in tmp_path.iterdir()} == {file.name for file in DOCS.glob("*.svg")}
    assert all("<svg" in file.read_text() for file in tmp_path.iterdir())
