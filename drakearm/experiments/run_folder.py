"""A run folder: all files of one run of a scenario, and enough to repeat it."""

import json
import re
import shutil
from pathlib import Path
from typing import Any

import yaml

from drakearm.errors import RunFolderError
from drakearm.experiments.scenario import Preset, Scenario, find_scenario, load_scenario


class RunFolder:
    """The files of a run; each step of a run reads those of the steps before it and writes its own."""

    FILES = {  # noqa: RUF012
        "scenario": "scenario.yaml",  # a copy of what was asked for
        "reference": "reference.npz",  # Reference: what the joints should do
        "plan": "plan.json",  # how it was found, its costs and margins, and whether the muscles can do it
        "plan_picture": "plan.png",
        "policy": "policy.safetensors",  # Policy: what was learned
        "training_log": "training.csv",  # a row a batch
        "training": "training.json",  # seed, steps, seconds
        "recording": "recording.npz",  # Recording of the deterministic run
        "metrics": "metrics.json",
        "replay": "replay.html",
    }

    def __init__(self, folder: Path):
        self.folder = folder
        self._paths = {name: folder / file for name, file in self.FILES.items()}

    def path(self, name: str) -> Path:
        """The path of a file to write."""
        return self._paths[name]

    def existing(self, name: str, step: str) -> Path:
        """The path of a file to read. Raises RunFolderError, naming the command that makes it, where it is missing."""
        if not self._paths[name].is_file():
            raise RunFolderError(f"{self._paths[name]} is missing: `drakearm {step}` makes it.")
        return self._paths[name]

    def claim(self, names: tuple[str, ...], overwrite: bool) -> None:
        """Makes the folder ready for a step that writes these files. Raises RunFolderError where one exists already."""
        present = [self._paths[name] for name in names if self._paths[name].exists()]
        if present and not overwrite:
            raise RunFolderError(
                f"{present[0]} exists already: choose another folder with --out, or replace it with --overwrite."
            )
        self.folder.mkdir(parents=True, exist_ok=True)

    def keep_scenario(self, scenario: str | Path, preset: Preset | None = None) -> Scenario:
        """Copies the scenario's file, and its arm if that is a user's own, into the folder and returns the scenario.

        preset: in place of the file's. Raises ScenarioError where it is not valid.
        """
        file, loaded = find_scenario(scenario), load_scenario(scenario)
        if file.resolve() == self.path("scenario").resolve():
            return loaded
        text = file.read_text()
        if preset is not None:
            text = re.sub(r"^preset:.*\n", "", text, flags=re.MULTILINE) + f"\npreset: {preset}\n"
        if Path(loaded.arm).is_absolute():
            shutil.copytree(loaded.arm, self.folder / "arm", dirs_exist_ok=True)
            text = yaml.safe_dump({**yaml.safe_load(text), "arm": "arm"}, sort_keys=False)
        self.path("scenario").write_text(text)
        return self.scenario()

    def scenario(self) -> Scenario:
        """The scenario of this run."""
        return load_scenario(self.existing("scenario", "plan"))

    def write_json(self, name: str, content: dict[str, Any]) -> None:
        self.path(name).write_text(json.dumps(content, indent=2) + "\n")

    def read_json(self, name: str, step: str) -> dict[str, Any]:
        """Raises RunFolderError where the file is missing or damaged."""
        file = self.existing(name, step)
        try:
            return json.loads(file.read_text())
        except ValueError as error:
            raise RunFolderError(f"{file} is damaged: {error}.") from error
