"""The shipped scenarios by name. Listing them reads only what the list shows, so that it is quick."""

import os
import re
from collections.abc import Mapping
from pathlib import Path

import yaml

from drakearm.errors import ScenarioError, did_you_mean, listed, shown

_SHIPPED = Path(__file__).parent / "scenarios"
POLICIES = Path(__file__).parents[1] / "policies"  # one folder per shipped scenario or repertoire
_FastLoader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # PyYAML may be built without its C part


def scenario_files() -> dict[str, Path]:
    """The shipped scenarios: name and file. Numbers in names are in numerical order: 2 kg before 10 kg."""

    def numbers(file: Path) -> list[str | int]:
        return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", file.stem)]

    return {file.stem: file for file in sorted(_SHIPPED.glob("*.yaml"), key=numbers)}


def scenario_descriptions() -> dict[str, str]:
    """The shipped scenarios: name and description."""
    return {
        name: yaml.load(file.read_text(encoding="utf-8"), _FastLoader)["description"]
        for name, file in scenario_files().items()
    }


def find_scenario(scenario: str | Path) -> Path:
    """The file of a shipped scenario, or the given path. Raises ScenarioError, listing names, if there is none."""
    return find_file(scenario, scenario_files(), "scenario")


def find_file(given: str | Path, shipped: Mapping[str, Path], what: str) -> Path:
    """The shipped file of this name, or the given path. what: scenario, or whatever the files are.

    Raises ScenarioError, listing names, if there is none.
    """
    file = shipped.get(str(given), Path(given))
    if not os.path.isfile(file):  # also if its name is too long or has a NUL character
        raise ScenarioError(
            f"There is no {what} {shown(str(given))}{did_you_mean(str(given), shipped)}: "
            f"expected the path of a file or one of {listed(shipped)}."
        )
    return file
