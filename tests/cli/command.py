"""Runs the command `drakearm` in this process, or in one of its own, and reads what it has written."""

import subprocess
import sys

from typer.testing import CliRunner

from drakearm.cli import app
from drakearm.errors import DrakearmError
from drakearm.experiments.run_folder import STEPS, RunFolder

RUN_FILES = {RunFolder.FILES[name] for step in ("plan", "train", "evaluate", "replay") for name in STEPS[step].files}


def drakearm(*arguments, code=0):
    """What the command prints, or the sentence of its error; it must exit with this code."""
    try:
        result = CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)
    except DrakearmError as error:
        assert code == 1, error
        return str(error)
    assert result.exit_code == code, result.output
    return result.output


def start(*arguments, **options):
    """Starts the command in a process of its own; its output is not a terminal unless the options say so."""
    command = [sys.executable, "-m", "drakearm.cli", *(str(a) for a in arguments)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(command, text=True, **{**pipes, **options})


def contents(run):
    """The content of each file in a run's folder, by the file's name."""
    return {file.name: file.read_bytes() for file in run.folder.iterdir()}
