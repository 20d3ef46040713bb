"""A run folder: all files of one run of a scenario. They are enough to repeat the run."""

import json
import re
import shutil
from pathlib import Path
from typing import Any

import yaml

from drakearm.errors import RunFolderError
from drakearm.experiments.catalog import find_scenario
from drakearm.experiments.choices import Preset
from drakearm.experiments.scenario import Scenario, load_scenario


class RunFolder:
    """The files of a run. Each step reads the files of the steps before it and writes its own."""

    FILES = {  # noqa: RUF012
        "scenario": "scenario.yaml",  # a copy of the scenario's file
        "reference": "reference.npz",  # Reference: the desired movement of the joints
        "plan": "plan.json",  # how it was found, its costs and margins, and whether the muscles can follow it
        "plan_picture": "plan.png",
        "policy": "policy.safetensors",  # the trained Policy
        "training_log": "training.csv",  # one row per batch
        "training": "training.json",  # seed, steps, seconds
        "recording": "recording.npz",  # Recording of the deterministic run
        "metrics": "metrics.json",
        "replay": "replay.html",
    }

    def __init__(self, folder: Path):
        self.folder = folder
        self._paths = {name: folder / file for name, file in self.FILES.items()}
        self._arm = folder / "arm"  # a copy of the arm, if it is not a shipped one

    def path(self, name: str) -> Path:
        """The path of a file to write."""
        return self._paths[name]

    def existing(self, name: str, step: str) -> Path:
        """The path of a file to read. If it is missing, a RunFolderError names the command that makes it, `step`."""
        if not self._paths[name].is_file():
            raise RunFolderError(f"{self._paths[name]} is missing: `drakearm {step}` makes it.")
        return self._paths[name]

    def claim(self, names: tuple[str, ...], overwrite: bool) -> None:
        """Makes the folder for a step that writes these files.

        Raises RunFolderError if one of them exists already, unless `overwrite` is true.
        """
        present = [self._paths[name] for name in names if self._paths[name].exists()]
        if present and not overwrite:
            raise RunFolderError(
                f"{present[0]} exists already: choose another folder with --out, or replace it with --overwrite."
            )
        self.folder.mkdir(parents=True, exist_ok=True)

    def keep_scenario(self, scenario: str | Path, preset: Preset | None = None) -> Scenario:
        """Copies the scenario's file into the folder, and its arm if it is not a shipped one. Returns the scenario.

        preset: replaces the preset in the file. Raises ScenarioError if the scenario is not valid.
        """
        file, loaded = find_scenario(scenario), load_scenario(scenario)
        if file.resolve() == self.path("scenario").resolve():
            return loaded
        text = _with_preset(file.read_text(), preset)
        if Path(loaded.arm).is_absolute():
            shutil.copytree(loaded.arm, self._arm, dirs_exist_ok=True)
            text = yaml.safe_dump({**yaml.safe_load(text), "arm": self._arm.name}, sort_keys=False)
        self.path("scenario").write_text(text)
        return self.scenario()

    def holds_plan_of(self, scenario: str | Path, preset: Preset | None = None) -> bool:
        """Whether the folder holds a plan of this scenario, with the same fields, preset and arm.

        preset: replaces the preset in the file. Raises ScenarioError if this scenario or the one in the folder is not
        valid.
        """
        if not all(self.path(name).is_file() for name in ("scenario", "reference", "plan")):
            return False
        self.scenario()  # raises the error if it is not valid
        file, arm = find_scenario(scenario), load_scenario(scenario).arm
        kept = {"preset": Preset.drakearm} | yaml.safe_load(self.path("scenario").read_text())
        fields = {"preset": Preset.drakearm} | yaml.safe_load(_with_preset(file.read_text(), preset))
        if not Path(arm).is_absolute():
            return kept == fields
        return kept == {**fields, "arm": kept.get("arm")} and _contents(Path(arm)) == _contents(self._arm)

    def scenario(self) -> Scenario:
        """The scenario of this run."""
        return load_scenario(self.existing("scenario", "plan"))

    def write_json(self, name: str, content: dict[str, Any]) -> None:
        self.path(name).write_text(json.dumps(content, indent=2) + "\n")

    def read_json(self, name: str, step: str) -> dict[str, Any]:
        """The content of a file. Raises RunFolderError if it is missing or damaged. step: the command that makes it."""
        file = self.existing(name, step)
        try:
            return json.loads(file.read_text())
        except ValueError as error:
            raise RunFolderError(f"{file} is damaged: {error}.") from error


def _with_preset(text: str, preset: Preset | None) -> str:
    """The text of a scenario's file with another preset, if one is given."""
    if preset is None:
        return text
    return re.sub(r"^preset:.*\n", "", text, flags=re.MULTILINE) + f"\npreset: {preset}\n"


def _contents(folder: Path) -> dict[Path, bytes]:
    """The content of each file in a folder and its subfolders, by its path relative to the folder."""
    return {file.relative_to(folder): file.read_bytes() for file in folder.rglob("*") if file.is_file()}
