"""A scenario that is quick to plan and to train, and a run of it."""

import shutil

import pytest
import yaml

from drakearm.experiments import RunFolder, scenario_files
from tests.cli.command import drakearm


@pytest.fixture(scope="session")
def tiny(tmp_path_factory):
    """A scenario like timing-0.7s that plans with few knots and trains on few arms."""
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    fields["movement"]["knots"] = 15
    fields["training"] = {"batches": 2, "environments": 4, "minibatches": 2, "epochs": 2}
    file = tmp_path_factory.mktemp("scenario") / "tiny.yaml"
    file.write_text(yaml.safe_dump({**fields, "name": "tiny"}))
    return str(file)


@pytest.fixture(scope="session")
def finished(tiny, tmp_path_factory):
    """The folder of a run with all steps, and what the command printed."""
    out = tmp_path_factory.mktemp("runs") / "tiny"
    printed = drakearm("run", tiny, "--out", out, "--seed", 3)
    return out, printed


@pytest.fixture
def run(finished, tmp_path):
    """A copy of the finished run, to change."""
    shutil.copytree(finished[0], tmp_path / "run")
    return RunFolder(tmp_path / "run")
