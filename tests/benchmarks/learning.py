"""How fast the arm is to learn with, next to other simulators and Stable-Baselines3: prints a table.

Run it with `python tests/benchmarks/learning.py`; it takes some minutes, and `--quick` only checks that it works. Rows
are of one core unless they say otherwise. They are measured round-robin, so that their ratios hold on a noisy machine.
The other packages are measured by the scripts in others/, each in its own process, where they are installed: in this
environment or in that of another interpreter, given with `--python elsewhere/bin/python`. OpenSim needs the paper's arm
as well: set the environment variable OPENSIM_MODEL to the path of 14muscles.osim.
"""

import argparse
import itertools
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import torch
from others.rates import rate, report
from rich.console import Console
from rich.table import Table

from drakearm.diagrams.muscle_arm import TIME_STEP
from drakearm.experiments.environments import make_task_env
from drakearm.experiments.metrics import run_policy
from drakearm.experiments.scenario import Scenario, load_scenario
from drakearm.learning import ArmVectorEnv, BatchReport, Policy, prepare, train
from drakearm.model import load_arm
from drakearm.model.reference import CONTROL_STEP
from drakearm.planning import plan
from drakearm.task import TrackingTask

OTHERS = Path(__file__).parent / "others"
SCENARIO = "timing-0.7s"
ERRORS = (0.05, 0.02)  # rad; reported is the time until the mean error of every joint is below
PPO_BATCHES, QUICK_PPO_BATCHES = 8, 3
QUICK_LEARNING = {"batches": 2, "imitation_rounds": 1}
ROUNDS, QUICK_ROUNDS = 3, 1

NOTE = """Ratio: control steps per second, relative to the first row. Memory: the most that the process had held so far.
Comparable: ArmVectorEnv, DiagramEnv and OpenSim, which step the same arm with 14 muscles by 10 ms. MotorNet, MuJoCo and
MyoSuite step other arms: their rows only show the order of magnitude. The two rows of PPO are comparable:
both step 64 arms of ArmVectorEnv and update the networks. Only these and the row of several processes count wall time,
all other rows count CPU time."""


@cache
def load_task() -> tuple[Scenario, TrackingTask]:
    """The scenario and its task."""
    scenario = load_scenario(SCENARIO)
    return scenario, scenario.task(plan(load_arm(scenario.arm), scenario.movement).reference)


def with_muscles(task: TrackingTask, count: int) -> TrackingTask:
    """The task for an arm with this many muscles: the first ones of its own, or all of them and copies."""
    own = task.arm.muscles
    muscles = tuple(replace(own[i % len(own)], name=f"muscle{i}") for i in range(count))
    return replace(task, arm=replace(task.arm, muscles=muscles))


def actions(task: TrackingTask, arms: int) -> Callable[[], np.ndarray]:
    """Excitations (arms, n) as an untrained policy draws them, different ones at every call."""
    drawn = np.random.default_rng(0).normal(0.15, 0.3, (100, arms, len(task.arm.muscles)))
    drawn = np.clip(drawn, 0.0, 1.0).astype(np.float32)
    again = itertools.cycle(drawn)
    return lambda: next(again)


def report_row(what: str, task: TrackingTask, arms: int, steps: float) -> None:
    muscles = len(task.arm.muscles)
    report(what, arms=arms, muscles=muscles, control_step=CONTROL_STEP, physics_step=TIME_STEP, steps=steps)


def measure_diagram(quick: bool) -> None:
    """DiagramEnv, over whole episodes."""
    _, task = load_task()
    env, draw = make_task_env(task), actions(task, 1)
    env.reset(seed=0)

    def step() -> None:
        *_, truncated, _ = env.step(draw()[0])
        if truncated:
            env.reset()

    report_row("DiagramEnv", task, 1, rate(step, quick))


def measure_vector(quick: bool, arms: int, muscles: int = 14, clock: Callable[[], float] = time.process_time) -> None:
    """ArmVectorEnv, over whole episodes."""
    task = with_muscles(load_task()[1], muscles)
    envs, draw = ArmVectorEnv(task, arms), actions(task, arms)
    envs.reset(seed=0)
    report_row("ArmVectorEnv", task, arms, arms * rate(lambda: envs.step(draw()), quick, clock))


def measure_ppo(quick: bool) -> None:
    """PPO with the scenario's settings, collecting and updating on two cores: the median batch without the first."""
    scenario, task = load_task()
    batches = QUICK_PPO_BATCHES if quick else PPO_BATCHES
    settings = replace(scenario.training, batches=batches, imitation_rounds=0)
    envs, times = ArmVectorEnv(task, settings.environments), []
    train(envs, settings, seed=0, metadata={}, on_batch=lambda _: times.append(time.perf_counter()))
    steps = settings.environments * settings.steps / statistics.median(np.diff(times))
    report_row("PPO on ArmVectorEnv", task, settings.environments, steps)


def measure_learning(quick: bool) -> None:
    """Seconds of training until the mean error of the policy without noise on the Diagram is below ERRORS."""
    scenario, task = load_task()
    settings = replace(scenario.training, **QUICK_LEARNING) if quick else scenario.training
    envs = ArmVectorEnv(task, settings.environments)
    seconds: dict[float, float] = {}
    began = time.perf_counter()
    pauses = error = 0.0
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "policy.safetensors"

        def evaluate(report: BatchReport) -> None:
            nonlocal pauses, error
            now = time.perf_counter()
            if file.exists():  # after every tenth of the training
                recording = run_policy(task, Policy.load(file))
                file.unlink()
                error = np.abs(recording.q - recording.reference_q).mean(axis=0).max()
                for goal in ERRORS:
                    if error < goal:
                        seconds.setdefault(goal, now - began - pauses)
            pauses += time.perf_counter() - now

        imitation = lambda actor: prepare(actor, [task], settings, seed=0)  # noqa: E731
        train(envs, settings, seed=0, metadata={}, prepare=imitation, checkpoint_path=file, on_batch=evaluate)
    total = time.perf_counter() - began - pauses
    print(json.dumps({"seconds": [seconds.get(goal) for goal in ERRORS], "total": total, "error": error}))


def measure_all(quick: bool) -> None:
    """All that takes one core, and PPO. The first row is the one that the others are compared with."""
    measure_vector(quick, 64)
    measure_vector(quick, 1)
    for muscles in (2, 7, 28):
        measure_vector(quick, 64, muscles)
    measure_diagram(quick)
    measure_vector(quick, 1024)
    measure_ppo(quick)


MEASUREMENTS: dict[str, Callable[[bool], None]] = {
    "all": measure_all,
    "vector": lambda quick: measure_vector(quick, 64, clock=time.perf_counter),
    "learning": measure_learning,
}


def run(*command: str, copies: int = 1) -> tuple[list[dict], str]:
    """The rows that a command prints, summed over copies that run at the same time; or no rows, and why."""
    one_core = os.environ | {"OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    processes = [subprocess.Popen(command, env=one_core, **pipes) for _ in range(copies)]
    outputs = [process.communicate() for process in processes]
    if any(process.returncode for process in processes):
        return [], (outputs[0][1].strip().splitlines() or ["failed"])[-1]
    rows = [[json.loads(line) for line in out.splitlines() if line.startswith("{")] for out, _ in outputs]
    for others in rows[1:]:
        for row, other in zip(rows[0], others, strict=True):
            for field in ("control_steps_per_second", "physics_steps_per_second", "memory"):
                row[field] += other[field]
    return rows[0], ""


def run_own(measurement: str, options: list[str], copies: int = 1) -> list[dict]:
    """The rows of one of the MEASUREMENTS."""
    rows, failure = run(sys.executable, __file__, measurement, *options, copies=copies)
    if failure:
        sys.exit(failure)
    return rows


def run_other(script: Path, interpreters: list[str], options: list[str]) -> list[dict]:
    """The rows of the first interpreter that has what the script needs, or one row that says what is missing."""
    failures = []
    for interpreter in interpreters:
        rows, failure = run(interpreter, str(script), *options)
        if rows:
            return rows
        failures.append(failure)
    # Where one interpreter has the package, it does not matter that another one has not.
    return [{"what": script.stem, "failure": min(failures, key=lambda failure: "not installed" in failure)}]


def run_all(interpreters: list[str], options: list[str]) -> list[dict]:
    """All rows once. The first is the one that the others are compared with."""
    rows, cores = run_own("all", options), os.cpu_count() or 1
    for row in run_own("vector", options, copies=cores):
        rows.append(row | {"what": f"ArmVectorEnv in {cores} processes", "arms": f"{cores} x 64"})
    return rows + [row for script in sorted(OTHERS.glob("*_*.py")) for row in run_other(script, interpreters, options)]


def describe(same: list[dict], units: list[dict]) -> list[str]:
    """One line of the table: medians over the rounds of a row and of its ratio to the first row."""
    row, key = same[0], "control_steps_per_second"
    steps = statistics.median(row[key] for row in same)
    ratio = statistics.median(row[key] / unit[key] for row, unit in zip(same, units, strict=True))
    return [
        row["what"],
        str(row["arms"]),
        str(row["muscles"]),
        f"{1000 * row['control_step']:g} ms",
        f"{steps:,.0f}",
        f"{steps * row['control_step'] / row['physics_step']:,.0f}" if row["physics_step"] else "-",
        f"{ratio:.3g}",
        f"{row['memory']:.0f}" if row["memory"] else "-",
    ]


def compare(interpreters: list[str], quick: bool) -> None:
    """Measures everything and prints the table."""
    console, options = Console(width=140), ["--quick"] if quick else []
    with console.status("measuring"):
        rounds = [run_all(interpreters, options) for _ in range(QUICK_ROUNDS if quick else ROUNDS)]
        (learned,) = run_own("learning", options)
    table = Table(
        "what", "arms", "muscles", "control step", "control steps/s", "physics steps/s", "ratio", "memory (MB)"
    )
    units, failures = [rows[0] for rows in rounds], []
    for same in zip(*rounds, strict=True):
        if "failure" in same[0]:
            failures.append(f"not measured: {same[0]['what']}: {same[0]['failure']}")
        else:
            table.add_row(*describe(list(same), units))
    console.print(table, *failures, NOTE, sep="\n")
    for error, seconds in zip(ERRORS, learned["seconds"], strict=True):
        console.print(f"{SCENARIO} to a mean error of {error} rad:", f"{seconds:.0f} s" if seconds else "not reached")
    console.print(f"{SCENARIO} to the end: {learned['total']:.0f} s, mean error {learned['error']:.4f} rad")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("measurement", nargs="?", choices=MEASUREMENTS, help="only this one, reported as lines of JSON")
    parser.add_argument("--quick", action="store_true", help="measures briefly: the same table, but it means nothing")
    parser.add_argument("--python", action="append", default=[], help="interpreter of another environment")
    arguments = parser.parse_args()
    if arguments.measurement:
        torch.set_num_threads(1)
        MEASUREMENTS[arguments.measurement](arguments.quick)
    else:
        compare([sys.executable, *arguments.python], arguments.quick)


if __name__ == "__main__":
    main()
