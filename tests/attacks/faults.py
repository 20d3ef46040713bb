"""Kills the commands at random moments and checks that nothing is damaged or lost: `make faults`.

    python tests/attacks/faults.py [--kills 100] [--seed 0] [--quick]

Every kill starts from the same finished run. One of plan, train, evaluate and replay replaces its results and is killed
(SIGKILL), at a random moment or just before a random one of its changes in the file system. Then:

- Every file is whole: it can be read.
- The folder is as it was before, or as the step leaves it: no mixture, and nothing lost.
- A training that was killed is continued, and ends with the same policy as without the kill, bit for bit.
- Going on works: the steps are done again, and give the same numbers as the run without kills.
"""

import argparse
import json
import logging
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import yaml
from PIL import Image
from rich.console import Console
from rich.table import Table

from drakearm.experiments import RunFolder, evaluate_step, plan_step, replay_step, scenario_files, train_step
from drakearm.experiments.run_folder import STEPS
from drakearm.learning import Policy
from drakearm.learning.checkpoint import Checkpoint
from drakearm.model import Recording, Reference, load_recordings

SEED = 1
ARRAYS = {"reference": Reference.load, "recording": Recording.load, "noisy": load_recordings}
READERS = {
    ".npz": lambda file: ARRAYS[file.stem](file),
    ".json": lambda file: json.loads(file.read_text()),
    ".yaml": lambda file: yaml.safe_load(file.read_text()),
    ".safetensors": lambda file: (Checkpoint if file.name == RunFolder.EXTRAS["checkpoint"] else Policy).load(file),
    ".png": lambda file: Image.open(file).load(),
    ".csv": lambda file: file.read_text().endswith("\n") or _fail(f"{file.name} ends in the middle of a line"),
    ".html": lambda file: file.read_text().endswith("-->\n") or _fail(f"{file.name} has no end"),
}

# Runs a command and kills the process just before its nth change of a file or folder in the run's folder.
KILLED_AT_CHANGE = """
import os, signal, sys
folder, last = sys.argv[1], int(sys.argv[2])
changes = 0

def count(event, arguments):
    global changes
    changing = event in ("os.mkdir", "os.rename", "os.remove", "os.rmdir", "shutil.copyfile", "shutil.rmtree")
    if event == "open":
        changing = isinstance(arguments[2], int) and arguments[2] & (os.O_WRONLY | os.O_RDWR)
    if changing and any(str(a).startswith(folder) for a in arguments[:2]):
        changes += 1
        if changes == last:
            os.kill(os.getpid(), signal.SIGKILL)

sys.addaudithook(count)
sys.argv = ["drakearm", *sys.argv[3:]]
from drakearm.cli import main
try:
    main()
finally:
    print("changes", changes, file=sys.stderr)
"""


def _fail(message: str) -> None:
    raise AssertionError(message)


class Attack:
    """A finished run, the commands that replace its parts, and what is checked after each kill."""

    def __init__(self, folder: Path):
        self.folder = folder
        fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
        fields["movement"]["knots"] = 15
        fields["training"] = {"batches": 6, "environments": 4, "minibatches": 2, "epochs": 2, "imitation_rounds": 1}
        self.scenario = folder / "tiny.yaml"
        self.scenario.write_text(yaml.safe_dump({**fields, "name": "tiny"}))
        self.finished = RunFolder(folder / "finished")
        self.go_on(self.finished)
        self.before = contents(self.finished)
        self.numbers = self._numbers(self.finished)
        self._measured: dict[str, tuple[float, int, bytes]] = {}

    def measure(self, step: str) -> tuple[float, int, bytes]:
        """Of a step that is not killed: its seconds, its number of changes, and the policy that it leaves."""
        if step not in self._measured:
            run, began = self.copy(), time.perf_counter()
            process = self.start(step, run, change=0)
            errors = process.communicate()[1]
            assert process.returncode == 0, errors
            policy = run.path("policy").read_bytes() if run.path("policy").exists() else b""
            self._measured[step] = time.perf_counter() - began, int(errors.split()[-1]), policy
        return self._measured[step]

    def copy(self) -> RunFolder:
        """The folder to attack: a copy of the finished run."""
        folder = self.folder / "attacked"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.finished.folder, folder)
        return RunFolder(folder)

    def start(self, step: str, run: RunFolder, change: int) -> subprocess.Popen:
        """Starts a step that replaces the results of the run. change: the one before which it is killed."""
        arguments = [step, self.scenario, "--out", run.folder, "--overwrite"]
        if step == "train":
            arguments += ["--seed", SEED + 1]  # other results than the finished ones, so that a mixture is noticed
        command = [sys.executable, "-c", KILLED_AT_CHANGE, run.folder, change, *arguments]
        return subprocess.Popen([str(a) for a in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def kill(self, step: str, chance: random.Random) -> None:
        """Kills a step and checks the folder. Raises an exception if something is wrong."""
        seconds, changes, _ = self.measure(step)
        run = self.copy()
        if chance.random() < 0.5:
            process = self.start(step, run, chance.randint(1, changes))
        else:
            process = self.start(step, run, 0)
            time.sleep(chance.uniform(0.0, seconds))
            process.kill()
        process.communicate()
        self.check(step, run)

    def check(self, step: str, run: RunFolder) -> None:
        """The folder after a kill: whole files, the state before or after the step, and going on works."""
        for file in run.folder.iterdir():
            if file.is_file():
                READERS[file.suffix](file)
        with run.locked():  # as the next command does: completes what was ready
            for name in RunFolder.FILES:
                if run.path(name).exists() and name != "replay":
                    run.existing(name, step)
        after = contents(run)
        later = [name for s in list(STEPS)[list(STEPS).index(step) + 1 :] for name in STEPS[s].files]
        kept = {n: c for n, c in self.before.items() if n not in {*STEPS[step].files, *later}}
        replaced = set(after) == set(RunFolder.FILES) - set(later) and {n: after[n] for n in kept} == kept
        assert after == self.before or replaced, f"{sorted(after)} is neither the state before nor after {step}"
        known = {*RunFolder.FILES.values(), RunFolder.EXTRAS["checkpoint"]}
        leftovers = [file.name for file in run.folder.iterdir() if file.name not in known]
        assert not leftovers, f"left behind: {leftovers}"
        if run.path("checkpoint").exists():
            train_step(run, seed=SEED + 1, resume=True)
            same = run.path("policy").read_bytes() == self.measure("train")[2]
            assert same, "the continued training ends with another policy than the one that was not killed"
        self.go_on(run, step)
        assert self._numbers(run) == self.numbers, "going on gives other numbers than the run without kills"

    def go_on(self, run: RunFolder, first: str = "plan") -> None:
        """Does a step and those after it again."""
        steps = list(STEPS)[list(STEPS).index(first) :]
        if "plan" in steps:
            plan_step(run, self.scenario)
        if "train" in steps:
            train_step(run, seed=SEED)
        if "evaluate" in steps:
            evaluate_step(run)
        replay_step(run)

    def _numbers(self, run: RunFolder) -> dict:
        metrics = run.read_json("metrics", "evaluate")
        return {key: value for key, value in metrics.items() if "seconds" not in key and key != "provenance"}


def contents(run: RunFolder) -> dict[str, bytes]:
    """The content of each file of a run, by name."""
    return {name: run.path(name).read_bytes() for name in RunFolder.FILES if run.path(name).exists()}


def attack(kills: int, seed: int, show: Console) -> int:
    """Kills the steps, prints a table and returns the number of failures."""
    logging.getLogger("drake").setLevel(logging.WARNING)  # Meshcat announces every page
    results: Counter = Counter()
    with tempfile.TemporaryDirectory() as folder:
        target = Attack(Path(folder))
        for number in range(kills):
            step = list(STEPS)[number % len(STEPS)]
            try:
                target.kill(step, random.Random(1000 * seed + number))
                results[step, "fine"] += 1
            except Exception as error:  # whatever goes wrong is a result
                results[step, "failed"] += 1
                show.print(f"kill {number} of {step}: {type(error).__name__}: {error}", markup=False)
            if (number + 1) % 10 == 0:
                show.print(f"{number + 1} of {kills} kills")
    table = Table("step", "kills", "consistent, went on", "failed")
    for step in STEPS:
        fine, failed = results[step, "fine"], results[step, "failed"]
        table.add_row(step, str(fine + failed), str(fine), str(failed))
    show.print(table)
    return sum(count for (_, result), count in results.items() if result == "failed")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0, help="of the moments; another one tries other moments")
    parser.add_argument("--quick", action="store_true", help="only 4 kills")
    options = parser.parse_args()
    sys.exit(min(attack(4 if options.quick else options.kills, options.seed, Console()), 1))
