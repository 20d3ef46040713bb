"""What the files of a run were made from: fingerprints of their inputs, kept in the JSON file of each step."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

_MODELS = ".yaml .yml .urdf .sdf .xml"
_SHAPES = ".obj .mtl .stl .dae .gltf .glb .bin .vtk .png .jpg .jpeg"
_ARM_FILES = {*_MODELS.split(), *_SHAPES.split(), ".md", ".txt"}  # the last two: credits and licenses

KEY = "provenance"  # of the record in a JSON file


@dataclass(frozen=True)
class Provenance:
    """Fingerprints by name: of the inputs that a step read, and of the files that it wrote."""

    made_from: Mapping[str, str]
    files: Mapping[str, str]

    @classmethod
    def read(cls, content: Mapping[str, Any]) -> "Provenance | None":
        """The record in the content of a JSON file; None if it has none."""
        try:
            return TypeAdapter(cls).validate_python(content.get(KEY))
        except ValidationError:
            return None


def fingerprint(path: Path) -> str:
    """The fingerprint of a file's content, or of all files of a folder and their names."""
    digest = hashlib.sha256()
    if path.is_file():
        digest.update(path.read_bytes())
    else:
        for file in folder_files(path):
            digest.update(f"{file.relative_to(path)}\0{file.stat().st_size}\0".encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()[:32]


def content_fingerprint(content: Mapping[str, Any]) -> str:
    """The fingerprint of a JSON file's content, without its record and without times: the same run has the same one."""
    kept = {key: value for key, value in content.items() if key != KEY and not key.endswith("seconds")}
    text = json.dumps(kept, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def folder_files(folder: Path) -> Iterator[Path]:
    """The files of an arm's folder and its subfolders that can belong to the arm, in alphabetical order."""
    for path in sorted(folder.iterdir()):
        if path.is_file() and path.suffix.lower() in _ARM_FILES:
            yield path
        elif path.is_dir() and not path.is_symlink() and not path.name.startswith("."):
            if not (path / "scenario.yaml").exists():  # that is a run
                yield from folder_files(path)
