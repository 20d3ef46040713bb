"""Imports run downwards only: a module imports from its own room and from those below."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LAYERS = [  # lowest first
    {"files"},
    {"muscle"},
    {"model"},
    {"task"},
    {"systems"},
    {"diagrams"},
    {"importing", "planning", "learning"},
    {"figures", "replay"},
    {"experiments"},
    {"reproduction", "repertoire"},
    {"cli"},
]
LEVEL = {room: level for level, layer in enumerate(LAYERS) for room in sorted(layer)}
FREE = {"errors", "lazy", "version", "gymnasium_registration"}  # below all layers
FOLDERS = [ROOT / room if room in ("systems", "diagrams") else ROOT / "drakearm" / room for room in LEVEL]
FILES = [file for folder in FOLDERS for file in sorted(folder.rglob("*.py"))]


def imported_rooms(file):
    """The rooms of drakearm that a file imports from, also inside functions."""
    for node in ast.walk(ast.parse(file.read_text())):
        names = []
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        for name in names:
            parts = name.split(".")
            if parts[0] == "drakearm" and len(parts) > 1:
                yield parts[1]


def test_all_rooms_have_a_layer():
    rooms = {folder.name for folder in (ROOT / "drakearm").iterdir() if (folder / "__init__.py").is_file()}
    assert rooms | {"systems", "diagrams"} == set(LEVEL)


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))
def test_imports_run_downwards(file):
    room = file.relative_to(ROOT).parts[0]
    room = room if room != "drakearm" else file.relative_to(ROOT).parts[1]
    for other in imported_rooms(file):
        if other in FREE:
            continue
        assert other == room or LEVEL[other] < LEVEL[room], f"{room} imports {other}"


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_no_module_hides_a_name_of_its_package(folder):
    """A module that is imported later would replace a function of the same name that its package has from elsewhere."""
    modules = {file.stem for file in folder.glob("*.py")}
    own = {folder.name, f"drakearm.{folder.name}"}
    for node in ast.walk(ast.parse((folder / "__init__.py").read_text())):
        if isinstance(node, ast.ImportFrom) and not {node.module, (node.module or "").rpartition(".")[0]} & own:
            names = {alias.asname or alias.name for alias in node.names}
            assert not names & modules, f"{folder.name}/__init__.py imports {names & modules} from {node.module}"
