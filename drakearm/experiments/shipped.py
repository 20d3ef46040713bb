"""The policies that drakearm ships, one per shipped scenario, and how a run gets one without training."""

import shutil
from pathlib import Path

from drakearm.errors import RunFolderError
from drakearm.experiments.catalog import POLICIES, find_scenario, scenario_files
from drakearm.experiments.run_folder import STEPS, RunFolder
from drakearm.experiments.steps import plan_step
from drakearm.files import read_json
from drakearm.model.loader import arm_folder

_FILES = (*STEPS["train"].files, "metrics")  # of a run, by their names in RunFolder


def shipped_run(scenario: str | Path) -> RunFolder | None:
    """The folder with the policy of a shipped scenario, how it was trained, and its metrics; None if there is none."""
    file = find_scenario(scenario)
    folder = POLICIES / file.stem
    return RunFolder(folder) if scenario_files().get(file.stem) == file and folder.is_dir() else None


def is_untrained(run: RunFolder, scenario: str | Path) -> bool:
    """Whether a folder holds nothing of a run, or only the plan that `plan_step` makes of a shipped scenario."""
    if not run.path("scenario").exists():
        return True
    later = [name for step in STEPS if step != "plan" for name in STEPS[step].files]
    if any(run.path(name).exists() for name in later) or not run.holds_plan_of(scenario):
        return False
    return run.read_json("plan", "plan").get("horizon") is None  # another plan is not what the policy was trained for


def adopt_step(run: RunFolder, scenario: str | Path, shipped: RunFolder) -> None:
    """Takes the shipped policy of a shipped scenario, in place of a training. Plans first if there is no plan."""
    if not run.holds_plan_of(scenario):
        plan_step(run, scenario)
    with run.replacing("train", arm_folder(run.scenario().arm)) as new:
        for name in STEPS["train"].files:
            if name != STEPS["train"].record:
                shutil.copyfile(shipped.path(name), new.path(name))
        new.write_record(read_json(shipped.path("training"), RunFolderError))


def ship(run: RunFolder, policies: Path) -> Path:
    """Copies the policy of an evaluated run, and how it was trained, into a folder of policies. Returns its place."""
    folder = policies / run.scenario().name
    folder.mkdir(parents=True, exist_ok=True)
    for name in _FILES:
        shutil.copyfile(run.existing(name, "evaluate"), folder / run.path(name).name)
    return folder
