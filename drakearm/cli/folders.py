"""The run folder that a command works in. While it works there, no other command can."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from drakearm.cli.console import say
from drakearm.errors import RunFolderError

if TYPE_CHECKING:
    from drakearm.experiments import RunFolder


@contextmanager
def run_folder(scenario: str, out: Path | None) -> "Iterator[RunFolder]":
    """The given folder, or the one with the scenario's name in runs/, locked. Made if it does not exist.

    Raises ScenarioError for an invalid scenario, RunFolderError if another command is at work there.
    """
    run = folder_of(scenario, out)
    with run.locked():
        yield run


@contextmanager
def learned_run_folder(scenario: str, out: Path | None) -> "Iterator[RunFolder]":
    """The folder of a run that has a policy, locked.

    A new folder, or one with only the plan, gets the policy that drakearm ships for the scenario. Raises RunFolderError
    if the folder has no policy and none is shipped.
    """
    from drakearm.experiments import adopt_step, shipped_run
    from drakearm.experiments.shipped import is_untrained

    run, shipped = folder_of(scenario, out), shipped_run(scenario)
    if shipped and is_untrained(run, scenario):
        with run.locked():
            adopt_step(run, scenario, shipped)
        say("using the policy that drakearm ships for this movement")
    with planned_run_folder(scenario, out) as run:
        run.existing("policy", f"train {scenario}")
        yield run


@contextmanager
def recorded_run_folder(scenario: str, out: Path | None) -> "Iterator[RunFolder]":
    """The folder of a run that has a recording, locked. If it has none, its policy is evaluated now.

    Raises RunFolderError if there is neither a recording nor a policy.
    """
    from drakearm.experiments import evaluate_step

    recorded = folder_of(scenario, out).path("recording").exists()
    with (planned_run_folder if recorded else learned_run_folder)(scenario, out) as run:
        if not recorded:
            evaluate_step(run)
        yield run


@contextmanager
def planned_run_folder(scenario: str, out: Path | None) -> "Iterator[RunFolder]":
    """The folder of a run that has a plan, locked. Raises RunFolderError if it has none, or one of another scenario."""
    from drakearm.experiments import load_scenario

    run = folder_of(scenario, out)
    if not run.folder.exists():
        run.existing("reference", f"plan {scenario}")  # raises the error
    with run.locked():
        run.existing("reference", f"plan {scenario}")
        expected, found = load_scenario(scenario).name, run.scenario().name
        if expected != found:
            raise RunFolderError(f"{run.folder} holds a run of {found}: expected {expected}.")
        yield run


@contextmanager
def existing_run(run: str) -> "Iterator[RunFolder]":
    """The folder of a run, locked: the given folder, or that of the scenario with this name or file in runs/.

    Raises RunFolderError if there is no run, ScenarioError if there is neither such a folder nor such a scenario.
    """
    from drakearm.experiments import RunFolder

    folder = RunFolder(Path(run)) if os.path.isdir(run) else folder_of(run, None)
    folder.existing("scenario", f"plan {run}")
    with folder.locked():
        yield folder


def folder_of(scenario: str, out: Path | None) -> "RunFolder":
    """The given folder, or the one with the scenario's name in runs/, which may not exist."""
    from drakearm.experiments import RunFolder, load_scenario

    return RunFolder(out or Path("runs") / load_scenario(scenario).name)


def say_removed(files: list[Path]) -> None:
    """Says which files of later steps were removed, because they were made from a file that has been replaced."""
    if files:
        say(f"removed what was made from the earlier files: {', '.join(file.name for file in files)}")
