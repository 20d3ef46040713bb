"""A small experiment: one short movement, which is quick to plan, to learn and to run."""

import json
from pathlib import Path

import yaml

from drakearm.experiments import scenario_files
from drakearm.reproduction.experiment import Experiment, all_methods, common_rows
from drakearm.reproduction.trial import Method

BATCHES = 6


def write_scenario(file: Path) -> Path:
    """A scenario like timing-0.7s, of a shorter movement, and with few knots and arms."""
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    fields["movement"] |= {"knots": 15, "duration": 0.3, "target_deg": [0, 40]}
    fields["training"] = {"batches": BATCHES, "environments": 4, "minibatches": 2, "epochs": 2, "imitation_rounds": 1}
    file.write_text(yaml.safe_dump({**fields, "name": "small"}))
    return file


class Small(Experiment):
    """The scenarios of some files, by some methods."""

    name = "small"
    title = "A small experiment"
    text = "One short movement."

    def __init__(self, *files, methods=tuple(Method)):
        self.files, self.methods = [str(file) for file in files], methods

    def trials(self, seeds):
        return [trial for trial in all_methods(self.files, seeds) if trial.method in self.methods]

    def rows(self, outcomes):
        return common_rows(outcomes, "")

    def figures(self, outcomes):
        return {}


def results(folder: Path):
    """The content of results.json, but for the seconds that it took."""
    content = json.loads((folder / "results.json").read_text())
    for experiment in content["experiments"].values():
        assert experiment.pop("seconds")
    return content
