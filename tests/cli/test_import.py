"""`drakearm import`: what it prints and writes, and its refusals."""

import sys
from pathlib import Path

import pytest

from tests.cli.command import drakearm

LEG = Path(__file__).parents[1] / "importing" / "leg.xml"
LOCKS = ("--lock", "hip=0,adduction=0")


def test_it_writes_a_folder_that_other_commands_take(tmp_path):
    pytest.importorskip("mujoco")
    folder = tmp_path / "leg"
    printed = drakearm("import", LEG, "--out", folder, *LOCKS, "--tip", "shank=0,0,-0.4")
    for part in ("Differences to MuJoCo", "vasti", "knee", "hip is locked at 0 degrees", "(0, 0, -0.4) m", "report.md"):
        assert part in printed, part
    assert {file.name for file in folder.iterdir()} == {"muscles.yaml", "skeleton.urdf", "CREDITS.md", "report.md"}
    assert "vasti" in drakearm("inspect", folder, "--out", tmp_path / "leg.png")
    assert "muscles.yaml exists already" in drakearm("import", LEG, "--out", folder, *LOCKS, code=1)
    drakearm("import", LEG, "--out", folder, *LOCKS, "--overwrite")


@pytest.mark.parametrize(
    "arguments, expected",
    [
        (("--lock", "hip"), "found --lock 'hip', expected a name, = and a number"),
        (("--freeze", "knee=x"), "found --freeze 'knee=x'"),
        (("--tip", "shank=1,2"), "found --tip 'shank=1,2', expected a body, = and three numbers"),
    ],
)
def test_options_are_checked(arguments, expected, tmp_path):
    printed = " ".join(drakearm("import", LEG, "--out", tmp_path / "leg", *arguments, code=2).split())
    assert expected in printed.replace("│ ", "").replace(" │", "")


@pytest.mark.parametrize("package, suffix", [("opensim", ".osim"), ("mujoco", ".xml")])
def test_a_missing_package_is_named(package, suffix, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    file = tmp_path / f"model{suffix}"
    file.write_text("")
    assert f"install it with `pip install {package}`" in drakearm("import", file, code=1)
