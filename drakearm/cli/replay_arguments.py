"""What the arguments of `drakearm replay` stand for: movements, and what drives the muscles in them."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from drakearm.cli.folders import existing_run, folder_of, learned_run_folder

if TYPE_CHECKING:
    from drakearm.experiments import RunFolder
    from drakearm.repertoire.driver import Driver
    from drakearm.repertoire.planned import PlannedMovement


@dataclass(frozen=True)
class Shown:
    """planned: None if the driver makes any movement. own: whether the driver was made for this one movement."""

    driver: "Driver"
    planned: "PlannedMovement | None"
    own: bool


@dataclass(frozen=True)
class Titled:
    """A movement, what drives the muscles in it, and what is written above it."""

    driver: "Driver"
    planned: "PlannedMovement"
    title: str


def is_scenario(argument: str) -> bool:
    """Whether an argument stands for a scenario, and not for the folder of a run or for a policy."""
    from drakearm.repertoire.driver import is_driver

    return not os.path.isdir(argument) and not is_driver(argument)


def find_shown(argument: str, out: Path | None = None, policy: str | None = None) -> Shown:
    """argument: a scenario, the folder of a run, a policy, or `static`. out: the folder of the scenario's run.

    policy: drives the muscles instead of the policy of the scenario or run. Raises a DrakearmError if something is
    missing, BadParameter if there are two policies.
    """
    from drakearm.repertoire.driver import find_driver

    if is_scenario(argument):
        if policy is None:
            with learned_run_folder(argument, out) as run:
                return _of_run(run)
        return Shown(find_driver(policy), _plan(argument, out), own=False)
    if os.path.isdir(argument):
        with existing_run(argument) as run:
            return _of_run(run, policy)
    if policy is not None:
        raise typer.BadParameter("expected a scenario or the folder of a run, not a second policy.", param_hint="RUN")
    driver = find_driver(argument)
    if driver.makes_all_movements:
        return Shown(driver, None, own=False)
    return Shown(driver, _movement_of(Path(argument), driver), own=True)


def titled(shown: Sequence[Shown]) -> list[Titled]:
    """Gives a movement to each driver that can make any: that of the others, or an example; and a title to all."""
    from drakearm.repertoire.planned import PlannedMovement
    from drakearm.repertoire.repertoire import load_repertoire

    shared = next((each.planned for each in shown if each.planned), None)
    if shared is None:
        own = (each.driver.repertoire for each in shown if each.driver.repertoire)
        shared = PlannedMovement.of_repertoire(next(own, None) or load_repertoire("reaching"))
    planned = [each.planned or shared for each in shown]
    alike = len(planned) > 1 and all(each is shared for each in planned)
    titles = [
        each.name if one.own and not alike else f"{each.name}: {one.driver.name}"
        for one, each in zip(shown, planned, strict=True)
    ]
    return [Titled(one.driver, each, title) for one, each, title in zip(shown, planned, titles, strict=True)]


def _of_run(run: "RunFolder", policy: str | None = None) -> Shown:
    """The movement of a run with its policy, or with another one. A run that needed none is static optimization."""
    from drakearm.learning import Policy
    from drakearm.repertoire.driver import STATIC, Driver, find_driver
    from drakearm.repertoire.planned import PlannedMovement

    if policy is None and run.path("recording").exists() and not run.path("policy").exists():
        policy = STATIC
    if policy is not None:
        return Shown(find_driver(policy), PlannedMovement.of_run(run), own=False)
    own = Policy.load(run.existing("policy", f"train {run.scenario().name}"))
    return Shown(Driver("own policy", own), PlannedMovement.of_run(run), own=True)


def _plan(scenario: str, out: Path | None) -> "PlannedMovement":
    """The movement of a scenario: from its run if there is a plan, else planned now."""
    from drakearm.experiments import load_scenario
    from drakearm.repertoire.planned import PlannedMovement

    run = folder_of(scenario, out)
    if run.path("reference").exists() and run.holds_plan_of(scenario):
        with run.locked():
            return PlannedMovement.of_run(run)
    return PlannedMovement.of_scenario(load_scenario(scenario))


def _movement_of(file: Path, driver: "Driver") -> "PlannedMovement":
    """The movement that a policy was trained for: from the run that the file is in, else planned now."""
    from drakearm.experiments import RunFolder, load_scenario
    from drakearm.repertoire.driver import scenario_of_policy
    from drakearm.repertoire.planned import PlannedMovement

    run = RunFolder(file.parent)
    if run.path("reference").exists():
        with run.locked():
            return PlannedMovement.of_run(run)
    assert driver.policy is not None
    return PlannedMovement.of_scenario(load_scenario(scenario_of_policy(file, driver.policy)))
