"""The run folder that a command works in. While it works there, no other command can."""

import os
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
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
    """The folder of a run that has a policy, locked. A new folder gets the policy that drakearm ships for the scenario.

    Raises RunFolderError if the folder has no policy and none is shipped.
    """
    from drakearm.experiments import adopt_step, shipped_run

    run, shipped = folder_of(scenario, out), shipped_run(scenario)
    if shipped and not run.path("scenario").exists():
        with run.locked():
            adopt_step(run, scenario, shipped)
        say("using the policy that drakearm ships for this movement")
    with planned_run_folder(scenario, out) as run:
        run.existing("policy", f"train {scenario}")
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
def newly_planned_run_folder(scenario: str, out: Path | None) -> "Iterator[RunFolder]":
    """The folder of a run that has a plan, locked. A new folder gets one.

    Raises RunFolderError as `planned_run_folder` does, PlanningError if there is no plan.
    """
    from drakearm.experiments import plan_step

    run = folder_of(scenario, out)
    if not run.path("scenario").exists():
        with run.locked():
            report = plan_step(run, scenario)
        say(f"planned {report.name}: {report.plan.status}; {report.feasibility.verdict}")
    with planned_run_folder(scenario, out) as run:
        yield run


@contextmanager
def opened(
    open_one: "Callable[[str, Path | None], AbstractContextManager[RunFolder]]", scenarios: list[str], out: Path | None
) -> "Iterator[list[RunFolder]]":
    """The folders of several runs, each opened by a function above. out: of the run if there is one, else of all."""
    with ExitStack() as stack:
        places = [(run.folder, scenario) for run, scenario in folders_of(scenarios, out).values()]
        yield [stack.enter_context(open_one(scenario, folder)) for folder, scenario in places]


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


def folders_of(scenarios: list[str], out: Path | None) -> "dict[str, tuple[RunFolder, str]]":
    """A folder for each scenario, by the scenario's name. out: holds these folders, or is the only one.

    Raises RunFolderError if two have the same name.
    """
    from drakearm.experiments import RunFolder, load_scenario

    runs: dict[str, tuple[RunFolder, str]] = {}
    for scenario in (several := dict.fromkeys(scenarios)):  # each once
        name = load_scenario(scenario).name
        if name in runs:
            raise RunFolderError(f"{runs[name][1]} and {scenario} are both named {name}: expected different names.")
        folder = out if out and len(several) == 1 else (out or Path("runs")) / name
        runs[name] = (RunFolder(folder), scenario)
    return runs


def say_removed(files: list[Path]) -> None:
    """Says which files of later steps were removed, because they were made from a file that has been replaced."""
    if files:
        say(f"removed what was made from the earlier files: {', '.join(dict.fromkeys(file.name for file in files))}")
