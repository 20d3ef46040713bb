"""What the command answers at once: help, versions, names and errors."""

import subprocess
import sys
from importlib.metadata import version

import pytest
import yaml

from drakearm.cli import main
from drakearm.cli.options import complete_scenario
from drakearm.experiments import scenario_files
from tests.cli.command import drakearm

HEAVY = ("torch", "scipy", "matplotlib", "pydrake", "pydantic", "numpy", "numba", "gymnasium")


@pytest.mark.parametrize("arguments", [["--help"], ["list"], ["--version"]])
def test_a_quick_answer_imports_nothing_heavy(arguments):
    code = f"""
import sys
from drakearm.cli import main
sys.argv = ["drakearm", *{arguments}]
try:
    main()
finally:
    print(*(name for name in {HEAVY} if name in sys.modules), file=sys.stderr)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout
    assert done.stderr.strip() == ""


@pytest.mark.slow
def test_a_move_needs_no_pytorch(tmp_path):
    code = f"""
import sys
from drakearm.cli import app
app(["move", "--to", "0.4", "0.6", "--out", {str(tmp_path)!r}], standalone_mode=False)
assert not {{"torch", "gymnasium"}} & set(sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "hand" in done.stdout and (tmp_path / "replay.html").exists()


def test_list_shows_the_shipped_scenarios():
    printed = drakearm("list")
    for name in scenario_files():
        assert name in printed


@pytest.mark.parametrize(
    "command", [[], *([name] for name in ("plan", "train", "evaluate", "replay", "export", "run", "inspect", "list"))]
)
def test_help_teaches(command):
    printed = drakearm(*command, "--help")
    assert len(printed) > 200
    if command and command[0] not in ("list", "inspect", "export"):
        assert "SCENARIO" in printed and "--out" in printed and "--import" in printed


def test_version():
    assert drakearm("--version").strip() == f"drakearm {version('drakearm')}"


def test_scenario_names_are_completed():
    assert [name for name, _ in complete_scenario("reach-0")] == ["reach-000", "reach-045", "reach-090"]
    assert len(complete_scenario("")) == len(scenario_files())


def test_unknown_scenario_lists_the_known_ones():
    assert "timing-0.7s" in drakearm("run", "dancing", code=1)


def test_a_close_name_is_suggested():
    assert "no scenario 'reach-45' (did you mean reach-045?)" in drakearm("run", "reach-45", code=1)
    assert "did you mean" not in drakearm("run", "dancing", code=1)


def failing(monkeypatch, capsys, *arguments):
    """What the entry point prints on stderr for a command that fails."""
    monkeypatch.setattr("sys.argv", ["drakearm", *arguments])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 1
    return capsys.readouterr().err


def test_errors_are_one_sentence_and_exit_code_1(monkeypatch, capsys):
    printed = failing(monkeypatch, capsys, "run", "dancing")
    assert "timing-0.7s" in printed and "Traceback" not in printed


@pytest.mark.parametrize("name", ["[/red]x", "[bold]x", "a[b", ":smile:"])
def test_square_brackets_in_names_are_shown(monkeypatch, capsys, name):
    assert f"'{name}'" in failing(monkeypatch, capsys, "plan", name)


def test_square_brackets_in_scenarios_and_paths_are_shown(tmp_path):
    fields = yaml.safe_load(scenario_files()["reach-000"].read_text())
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump({**fields, "name": "[bold]mine", "description": "$5 [/red] $x^$"}))
    out = tmp_path / "[red]run"
    printed = drakearm("plan", file, "--out", out)
    assert "[bold]mine" in printed and str(out) in printed
    printed = drakearm("plan", file, "reach-000", "--out", tmp_path / "[red]runs")
    assert "[bold]mine" in printed.replace("\n", "") and "[red]runs" in printed


def test_drake_does_not_announce_its_servers():
    """Its level is set anew when Drake is imported, which happens inside a command."""
    code = """
import logging, sys
from drakearm.cli import main
sys.argv = ["drakearm", "--version"]
try:
    main()
finally:
    import pydrake.common
    logging.getLogger("drake").info("Meshcat listening")
    logging.getLogger("drake").warning("a warning")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "Meshcat listening" not in done.stderr and "a warning" in done.stderr
