"""A run folder: all files of one run of a scenario. They are enough to repeat the run.

Each step of a run reads the files of the steps before it and writes its own, all of them together. The JSON file of a
step records what the files were made from. So the files of a folder always belong to each other: what was made from a
file that is replaced is removed, and what was changed or copied from elsewhere is refused.
"""

import json
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from drakearm.errors import ArmError, RunFolderError, ScenarioError, shown
from drakearm.experiments.catalog import find_scenario
from drakearm.experiments.choices import Preset
from drakearm.experiments.provenance import KEY, Provenance, content_fingerprint, fingerprint, folder_files
from drakearm.experiments.scenario import Scenario, load_scenario
from drakearm.files.formats import FORMAT, NEWEST
from drakearm.files.lock import locked
from drakearm.files.reading import read_json, read_yaml
from drakearm.files.together import recover, replaced_together
from drakearm.files.writing import storage
from drakearm.model.loader import arm_folder
from drakearm.model.reference import Reference
from drakearm.task import TrackingTask


class Step(NamedTuple):
    """What a step of a run reads and writes, by the names in RunFolder.FILES and RunFolder.EXTRAS."""

    inputs: tuple[str, ...]
    files: tuple[str, ...]
    record: str  # the one of these files that records what they were made from
    extras: tuple[str, ...] = ()  # what it writes in some runs only


STEPS = {  # in the order of a run
    "plan": Step(("scenario", "arm"), ("reference", "plan", "plan_picture", "scenario"), "plan", ("arm",)),
    "train": Step(
        ("scenario", "arm", "reference"), ("policy", "training", "training_log"), "training", ("checkpoint",)
    ),
    "evaluate": Step(
        ("scenario", "arm", "reference", "policy"), ("metrics", "recording", "noisy", "movement_picture"), "metrics"
    ),
    "replay": Step(("scenario", "arm", "recording"), ("replay",), "replay"),  # as a comment in the page
    "perturb": Step(("scenario", "arm", "reference", "policy"), ("perturbed", "perturbed_recording"), "perturbed"),
    "robust": Step(("scenario", "arm", "reference", "policy"), ("robustness", "robust_runs"), "robustness"),
    "single": Step(("scenario", "arm", "reference", "policy"), ("single",), "single"),
}


_SCRATCH = ".unfinished"


class RunFolder:
    """The files of a run."""

    FILES = {  # noqa: RUF012
        "scenario": "scenario.yaml",  # a copy of the scenario's file
        "reference": "reference.npz",  # Reference: the desired movement of the joints
        "plan": "plan.json",  # how it was found, its costs and margins, and whether the muscles can follow it
        "plan_picture": "plan.png",
        "policy": "policy.safetensors",  # the trained Policy
        "training_log": "training.csv",  # one row per batch
        "training": "training.json",  # seed, steps, seconds
        "recording": "recording.npz",  # Recording of the run without noise
        "noisy": "noisy.npz",  # Recordings of the runs with noise, see `load_recordings`
        "movement_picture": "movement.png",
        "metrics": "metrics.json",
        "replay": "replay.html",
        "perturbed": "perturbed.json",  # metrics of runs on a perturbed arm, with this policy or another one
        "perturbed_recording": "perturbed.npz",  # Recording of the first of these runs
        "robustness": "robustness.json",  # metrics of runs with the perturbations of the scenario
        "robust_runs": "robustness.npz",  # Recordings of these runs
        "single": "single_perturbations.json",  # errors with one perturbation at a time
    }
    EXTRAS = {  # noqa: RUF012
        "arm": "arm",  # a copy of the arm's folder, if it is not a shipped one
        "checkpoint": "checkpoint.safetensors",  # of a training that is not finished: what it needs to go on
    }

    def __init__(self, folder: Path):
        self.folder = Path(folder)
        self._locks = 0  # how often this object has locked the folder

    def path(self, name: str) -> Path:
        """The path of a file or of an extra, which may not exist."""
        return self.folder / _file_name(name)

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Makes the folder and keeps other processes out of it. What a killed process left half done is completed.

        Raises RunFolderError if another process is at work in the folder, StorageError if it cannot be made.
        """
        with storage(self.folder, "cannot be made"):
            if self.folder.exists() and not self.folder.is_dir():
                raise RunFolderError(f"{shown(self.folder)} is a file: expected a folder for the files of the run.")
            self.folder.mkdir(parents=True, exist_ok=True)
        with nullcontext() if self._locks else locked(self.folder):
            self._locks += 1
            try:
                if self._locks == 1:
                    recover(self.folder)
                    shutil.rmtree(self.folder / _SCRATCH, ignore_errors=True)
                yield
            finally:
                self._locks -= 1

    @contextmanager
    def scratch(self) -> Iterator[Path]:
        """A folder for unfinished files, which is removed at the end of the `with` block, or by the next command."""
        with storage(self.folder):
            (self.folder / _SCRATCH).mkdir()
        try:
            yield self.folder / _SCRATCH
        finally:
            shutil.rmtree(self.folder / _SCRATCH, ignore_errors=True)

    def claim(self, step: str, overwrite: bool) -> list[Path]:
        """Checks that a step may write its files. Returns the files of later steps, which it will remove.

        Raises RunFolderError if one of these files exists already, unless `overwrite` is true.
        """
        own = [self.path(name) for name in STEPS[step].files if self.path(name).exists()]
        later = [self.path(n) for other in _after(step) for n in STEPS[other].files if self.path(n).exists()]
        if (own or later) and not overwrite:
            raise RunFolderError(
                f"{shown((own + later)[0])} exists already: choose another folder with --out, "
                "or replace it with --overwrite."
            )
        return later

    @contextmanager
    def replacing(self, step: str, arm: Path) -> "Iterator[NewFiles]":
        """The new files of a step. At the end of the `with` block they replace the old ones, and those of later steps
        are removed.

        arm: the folder of the arm that the step used. If the block raises an exception, the folder stays as it was.
        """
        removed = [*STEPS[step].extras, *(n for s in _after(step) for n in (*STEPS[s].files, *STEPS[s].extras))]
        with self.locked(), replaced_together(self.folder, map(_file_name, removed)) as staged:
            yield NewFiles(self, step, staged, arm)

    def existing(self, name: str, command: str) -> Path:
        """The path of a file to read. command: the one that makes it, for messages.

        Raises RunFolderError if the file is missing, is not what the step wrote, or was made from other files than
        those that are in the folder.
        """
        self._check(name, command)
        return self.path(name)

    def read_json(self, name: str, command: str) -> dict[str, Any]:
        """The content of a JSON file. Raises RunFolderError as `existing` does, and if it is damaged."""
        return read_json(self.existing(name, command), RunFolderError)

    def scenario(self, preset: Preset | None = None) -> Scenario:
        """The scenario of this run. preset: replaces the one in the file."""
        return load_scenario(self.existing("scenario", "plan"), preset)

    def task(self, scenario: Scenario) -> TrackingTask:
        """The task of this run: to follow its plan. scenario: that of this run."""
        return scenario.task(Reference.load(self.existing("reference", "plan")))

    def holds_plan_of(self, scenario: str | Path, preset: Preset | None = None) -> bool:
        """Whether the folder holds a plan of this scenario, with the same fields, preset and arm.

        preset: replaces the preset in the file. Raises ScenarioError if this scenario is not valid.
        """
        loaded, fields = load_scenario(scenario), _fields(scenario, preset)
        try:
            kept = _fields(self.existing("scenario", "plan"))
            self.existing("reference", "plan")
        except (RunFolderError, ScenarioError):
            return False
        if not Path(loaded.arm).is_absolute():
            return kept == fields
        copied = self.path("arm")
        return kept == {**fields, "arm": kept.get("arm")} and fingerprint(Path(loaded.arm)) == fingerprint(copied)

    def _check(self, name: str, command: str) -> None:
        """Raises RunFolderError if a file, or one that it was made from, is not what the record of its step says."""
        file, step = self.path(name), _maker(name)
        if not file.is_file():
            raise RunFolderError(f"{shown(file)} is missing: `drakearm {command}` makes it.")
        again = f"`drakearm {step} --overwrite` makes it again."
        record_file = self.path(STEPS[step].record)
        if not record_file.is_file():
            raise RunFolderError(f"{shown(record_file)}, which belongs to {file.name}, is missing: {again}")
        content = read_json(record_file, RunFolderError)
        record = Provenance.read(content)
        is_record = file == record_file
        found = content_fingerprint(content) if is_record else fingerprint(file)
        if record is None or record.files.get(file.name) != found:
            raise RunFolderError(f"{shown(file)} is not the file that `drakearm {step}` wrote: {again}")
        for source in STEPS[step].inputs:
            if record.made_from.get(_file_name(source)) != self._fingerprint(source):
                raise RunFolderError(f"{shown(file)} was made from another {_file_name(source)}: {again}")
            if source != "arm" and _maker(source) != step and self.path(source).exists():
                self._check(source, _maker(source))

    def _fingerprint(self, name: str) -> str:
        """The fingerprint of an input as it is now; empty if it is missing."""
        if name != "arm":
            return fingerprint(self.path(name)) if self.path(name).is_file() else ""
        try:
            return fingerprint(arm_folder(load_scenario(self.path("scenario")).arm))
        except ArmError:
            return ""


class NewFiles:
    """The new files of a step, which are in the run folder when all of them are complete."""

    def __init__(self, run: RunFolder, step: str, staged: Path, arm: Path):
        self._run, self._step, self._staged, self._arm = run, step, staged, arm

    def path(self, name: str) -> Path:
        """Where to write a file."""
        return self._staged / _file_name(name)

    def keep_scenario(self, scenario: str | Path, preset: Preset | None = None) -> None:
        """Copies the scenario's file, and its arm if it is not a shipped one. preset: replaces the one in the file."""
        arm = Path(load_scenario(scenario).arm)
        if preset is None and not arm.is_absolute():
            shutil.copyfile(find_scenario(scenario), self.path("scenario"))
            return
        fields = _fields(scenario, preset)
        if arm.is_absolute():
            for file in folder_files(arm):
                copy = self.path("arm") / file.relative_to(arm)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, copy)
            fields["arm"] = _file_name("arm")
        self.path("scenario").write_text(yaml.safe_dump(fields, sort_keys=False), encoding="utf-8")

    def keep_preset(self, preset: Preset) -> None:
        """Writes another preset into the run's scenario. The plan stays, because it does not depend on the preset."""
        scenario, plan = _file_name("scenario"), read_json(self._run.path("plan"), RunFolderError)
        fields = _fields(self._run.path("scenario"), preset)
        self.path("scenario").write_text(yaml.safe_dump(fields, sort_keys=False), encoding="utf-8")
        for found in (plan[KEY]["made_from"], plan[KEY]["files"]):
            found[scenario] = fingerprint(self.path("scenario"))
        self._write_json("plan", plan)

    def made_from(self) -> dict[str, str]:
        """The fingerprints of the step's inputs; empty for one that is missing because the step did without it."""
        found = {}
        for name in STEPS[self._step].inputs:
            earlier = self._arm if name == "arm" else self._run.path(name)
            source = self.path(name) if self.path(name).exists() else earlier
            found[_file_name(name)] = fingerprint(source) if source.exists() else ""
        return found

    def write_record(self, content: Mapping[str, Any]) -> None:
        """Writes the JSON file of the step, with what its files were made from. It comes after all other files."""
        step = STEPS[self._step]
        others = [name for name in step.files if name != step.record]
        others += [name for name in step.extras if self.path(name).exists()]
        files = {_file_name(name): fingerprint(self.path(name)) for name in others}
        files[_file_name(step.record)] = content_fingerprint(content)
        provenance = asdict(Provenance(made_from=self.made_from(), files=files))
        self._write_json(step.record, {FORMAT: NEWEST, **content, KEY: provenance})

    def _write_json(self, name: str, content: Mapping[str, Any]) -> None:
        self.path(name).write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def _file_name(name: str) -> str:
    return (RunFolder.FILES | RunFolder.EXTRAS)[name]


def _maker(name: str) -> str:
    """The step that writes a file or an extra."""
    return next(maker for maker, step in STEPS.items() if name in (*step.files, *step.extras))


def _after(step: str) -> list[str]:
    """The steps that read what a step writes, or what one of these steps writes."""
    later: list[str] = []
    for name, other in STEPS.items():
        if name != step and any(_maker(source) in (step, *later) for source in other.inputs):
            later.append(name)
    return later


def _fields(scenario: str | Path, preset: Preset | None = None) -> dict[str, Any]:
    """The fields of a scenario's file, with the default preset where it has none, or with another one."""
    fields = {"preset": Preset.drakearm.value} | read_yaml(find_scenario(scenario), ScenarioError)
    return fields if preset is None else fields | {"preset": preset.value}
