"""The package as a user gets it: complete, and able to do what README.md says, in an empty folder."""

import os
import re
import subprocess
import sys
import tarfile
import venv
from pathlib import Path
from zipfile import ZipFile

import pytest
import yaml

ROOT = Path(__file__).parents[1]
SHIPPED = ("drakearm", "systems", "diagrams")

pytestmark = [pytest.mark.slow, pytest.mark.extra]


def run(*command, cwd, **variables) -> str:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | variables
    done = subprocess.run(list(map(str, command)), cwd=cwd, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def tracked() -> list[str]:
    return run("git", "ls-files", cwd=ROOT).splitlines()


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    """A folder with the source archive, and the wheel that was built from it."""
    sources, built = tmp_path_factory.mktemp("sources"), tmp_path_factory.mktemp("built")
    for name in tracked():
        if name.startswith(SHIPPED) or "/" not in name:
            target = sources / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes((ROOT / name).read_bytes())
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", built, cwd=sources)
    return built


@pytest.fixture(scope="module")
def installed(built, tmp_path_factory) -> Path:
    """The programs of a new environment. It sees the packages of this one, but has a drakearm of its own."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False)
    packages = next(folder.glob("lib/*/site-packages"))
    seen = [path for path in sys.path if path.endswith("site-packages")]
    (packages / "seen.pth").write_text("\n".join(seen))
    python, wheel = folder / "bin" / "python", next(built.glob("*.whl"))
    run(sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-deps", wheel, cwd=folder)
    return folder / "bin"


def test_the_wheel_has_every_file_of_the_package(built):
    with ZipFile(next(built.glob("*.whl"))) as wheel:
        found = {name for name in wheel.namelist() if ".dist-info/" not in name}
    moved = {name: f"drakearm/{name}" for name in tracked() if name.startswith(("systems/", "diagrams/"))}
    expected = {moved.get(name, name) for name in tracked() if name.startswith(tuple(f"{top}/" for top in SHIPPED))}
    assert found == expected


def test_the_source_archive_has_what_a_reader_needs(built):
    with tarfile.open(next(built.glob("*.tar.gz"))) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {"README.md", "LICENSE", "pyproject.toml", "systems/hill_muscles.py"} <= names


def test_the_commands_of_the_readme_work_in_an_empty_folder(installed, tmp_path):
    place = run(installed / "python", "-c", "import drakearm; print(drakearm.__file__)", cwd=tmp_path)
    assert Path(place.strip()).is_relative_to(installed.parent)
    drakearm = installed / "drakearm"
    assert run(drakearm, "--version", cwd=tmp_path).startswith("drakearm ")
    assert "reach-000" in run(drakearm, "list", cwd=tmp_path)
    run(drakearm, "inspect", "arm14", cwd=tmp_path)
    run(drakearm, "replay", "reach-000", cwd=tmp_path)
    run(drakearm, "export", "reach-000", "--csv", cwd=tmp_path)
    run(drakearm, "move", "--to", "0.4", "0.6", cwd=tmp_path)
    run(drakearm, "plan", "obstacle", cwd=tmp_path)
    assert len(list(tmp_path.rglob("replay.html"))) == 2
    assert (tmp_path / "runs" / "obstacle" / "plan.png").is_file()


def test_the_python_of_the_readme_runs_in_an_empty_folder(installed, tmp_path):
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), flags=re.DOTALL)
    run(installed / "python", "-c", "\n".join(blocks), cwd=tmp_path)


def test_the_files_for_github_are_valid():
    files = [ROOT / name for name in tracked() if name.startswith(".github/")]
    assert len(files) >= 5
    for file in files:
        assert isinstance(yaml.safe_load(file.read_text()), dict), file
