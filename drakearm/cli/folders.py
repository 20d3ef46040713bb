"""The run folder that a command works in."""

from pathlib import Path
from typing import TYPE_CHECKING

from drakearm.errors import RunFolderError

if TYPE_CHECKING:
    from drakearm.experiments import RunFolder


def run_folder(scenario: str, out: Path | None) -> "RunFolder":
    """The given folder, or the one with the scenario's name in runs/. Raises ScenarioError for an invalid scenario."""
    from drakearm.experiments import RunFolder, load_scenario

    return RunFolder(out or Path("runs") / load_scenario(scenario).name)


def planned_run_folder(scenario: str, out: Path | None) -> "RunFolder":
    """The folder of a run that has a plan. Raises RunFolderError if it has none, or one of another scenario."""
    from drakearm.experiments import load_scenario

    run = run_folder(scenario, out)
    run.existing("reference", f"plan {scenario}")
    expected, found = load_scenario(scenario).name, run.scenario().name
    if expected != found:
        raise RunFolderError(f"{run.folder} holds a run of {found}: expected {expected}.")
    return run
