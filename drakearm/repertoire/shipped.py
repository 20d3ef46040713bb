"""The policies that drakearm ships for its repertoires, and how one is shipped."""

import json
import shutil
from pathlib import Path
from typing import Any

from drakearm.errors import PolicyFileError, shown
from drakearm.experiments.catalog import POLICIES
from drakearm.learning import Policy
from drakearm.repertoire.folder import FILES
from drakearm.repertoire.repertoire import Repertoire, load_repertoire, repertoire_files

_SHIPPED = ("policy", "errors", "picture", "repertoire")


def shipped_policy(name: str) -> Policy:
    """The policy of a shipped repertoire. Raises PolicyFileError if there is none."""
    file = POLICIES / name / FILES["policy"]
    if not file.exists():
        raise PolicyFileError(f"drakearm ships no policy for the repertoire {shown(name)}.")
    return Policy.load(file)


def shipped_errors(name: str) -> dict[str, Any]:
    """The content of errors.json of a shipped policy: how it was trained, and its errors in held-out movements."""
    content: dict[str, Any] = json.loads((POLICIES / name / FILES["errors"]).read_text(encoding="utf-8"))
    return content


def policy_and_repertoire(file: Path | None) -> tuple[Policy, Repertoire]:
    """A policy file and the repertoire that it was trained for, beside it; the shipped `reaching` without a file.

    Raises PolicyFileError if the file has a policy for something else.
    """
    if file is None:
        return shipped_policy("reaching"), load_repertoire("reaching")
    policy = Policy.load(file)
    beside = file.parent / FILES["repertoire"]
    name = str(policy.metadata.get("repertoire"))
    if not beside.exists() and name not in repertoire_files():
        raise PolicyFileError(
            f"{shown(file)} is no policy for a repertoire of movements: expected one that `drakearm learn` wrote, with "
            f"its {FILES['repertoire']} beside it."
        )
    return policy, load_repertoire(beside if beside.exists() else name)


def ship(folder: Path, policies: Path) -> Path:
    """Copies what was learned in a folder into a folder of policies. Returns its place."""
    content = json.loads((folder / FILES["errors"]).read_text(encoding="utf-8"))
    place: Path = policies / content["repertoire"]
    place.mkdir(parents=True, exist_ok=True)
    for name in _SHIPPED:
        shutil.copyfile(folder / FILES[name], place / FILES[name])
    return place
