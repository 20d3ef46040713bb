"""How fast the arm is to learn with, next to other simulators and Stable-Baselines3: prints a table.

Run it with `python tests/benchmarks/learning.py`; it takes some minutes. Rows are of one core unless they say
otherwise, and take turns, so that their ratios hold on a noisy machine. The others are scripts in the folder others/,
each run in a process of its own, where their packages are installed: in this environment or in that of another
interpreter, given with `--python elsewhere/bin/python`.
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

from drakearm.diagrams import TrackingTask
from drakearm.diagrams.muscle_arm import TIME_STEP
from drakearm.experiments.environments import make_task_env
from drakearm.experiments.metrics import run_policy
from drakearm.experiments.scenario import Scenario, load_scenario
from drakearm.learning import ArmVectorEnv, BatchReport, Policy, imitate, train
from drakearm.learning.policy import Actor
from drakearm.model import load_arm
from drakearm.model.reference import CONTROL_STEP
from drakearm.planning import plan

OTHERS = Path(__file__).parent / "others"
SCENARIO = "timing-0.7s"
ERRORS = (0.05, 0.02)  # rad, means of each joint, that learning is timed to
PPO_BATCHES = 8
ROUNDS = 3


@cache
def load_task() -> tuple[Scenario, TrackingTask]:
    """The scenario and its task."""
    scenario = load_scenario(SCENARIO)
    return scenario, scenario.task(plan(load_arm(scenario.arm), scenario.movement).reference)


def with_muscles(task: TrackingTask, count: int) -> TrackingTask:
    """The task for an arm with a number of muscles: the first of its own, or all of them and copies."""
    own = task.arm.muscles
    muscles = tuple(replace(own[i % len(own)], name=f"muscle{i}") for i in range(count))
    return replace(task, arm=replace(task.arm, muscles=muscles))


def actions(task: TrackingTask, arms: int) -> Callable[[], np.ndarray]:
    """Excitations (arms, n) as an untrained policy draws them, others at every call."""
    drawn = np.random.default_rng(0).normal(0.15, 0.3, (100, arms, len(task.arm.muscles)))
    drawn = np.clip(drawn, 0.0, 1.0).astype(np.float32)
    again = itertools.cycle(drawn)
    return lambda: next(again)


def tell(what: str, task: TrackingTask, arms: int, steps: float) -> None:
    muscles = len(task.arm.muscles)
    report(what, arms=arms, muscles=muscles, control_step=CONTROL_STEP, physics_step=TIME_STEP, steps=steps)


def measure_diagram() -> None:
    """DiagramEnv, over whole episodes."""
    _, task = load_task()
    env, draw = make_task_env(task), actions(task, 1)
    env.reset(seed=0)

    def step() -> None:
        *_, truncated, _ = env.step(draw()[0])
        if truncated:
            env.reset()

    tell("DiagramEnv", task, 1, rate(step))


def measure_vector(arms: int, muscles: int = 14, clock: Callable[[], float] = time.process_time) -> None:
    """ArmVectorEnv, over whole episodes."""
    task = with_muscles(load_task()[1], muscles)
    envs, draw = ArmVectorEnv(task, arms), actions(task, arms)
    envs.reset(seed=0)
    tell("ArmVectorEnv", task, arms, arms * rate(lambda: envs.step(draw()), clock))


def measure_ppo() -> None:
    """PPO with the scenario's settings, collecting and updating on two cores: the median batch but the first."""
    scenario, task = load_task()
    settings = replace(scenario.training, batches=PPO_BATCHES)
    envs, times = ArmVectorEnv(task, settings.environments), []
    train(envs, settings, seed=0, metadata={}, on_batch=lambda _: times.append(time.perf_counter()))
    steps = settings.environments * settings.steps / statistics.median(np.diff(times))
    tell("PPO on ArmVectorEnv", task, settings.environments, steps)


def measure_learning() -> None:
    """Seconds of training until the policy without noise errs by less than ERRORS on the Diagram."""
    scenario, task = load_task()
    envs = ArmVectorEnv(task, scenario.training.environments)
    seconds: dict[float, float] = {}
    began = time.perf_counter()
    pauses = error = 0.0
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "policy.safetensors"

        def evaluate(report: BatchReport) -> None:
            nonlocal pauses, error
            now = time.perf_counter()
            if file.exists():  # every tenth of the training
                recording = run_policy(task, Policy.load(file))
                file.unlink()
                error = np.abs(recording.q - recording.reference_q).mean(axis=0).max()
                for wanted in ERRORS:
                    if error < wanted:
                        seconds.setdefault(wanted, now - began - pauses)
            pauses += time.perf_counter() - now

        def prepare(actor: Actor) -> None:
            imitate(actor, [task], scenario.training.imitation_rounds, seed=0)

        settings = scenario.training
        train(envs, settings, seed=0, metadata={}, prepare=prepare, checkpoint_path=file, on_batch=evaluate)
    total = time.perf_counter() - began - pauses
    print(json.dumps({"seconds": [seconds.get(wanted) for wanted in ERRORS], "total": total, "error": error}))


def measure_all() -> None:
    """All that takes one core, the one that others are compared with first."""
    measure_vector(64)
    measure_vector(1)
    for muscles in (2, 7, 28):
        measure_vector(64, muscles)
    measure_diagram()
    measure_vector(1024)
    measure_ppo()


MEASUREMENTS: dict[str, Callable[[], None]] = {
    "all": measure_all,
    "vector": lambda: measure_vector(64, clock=time.perf_counter),
    "learning": measure_learning,
}


def run(*command: str, copies: int = 1) -> tuple[list[dict], str]:
    """The rows that a command prints, summed over copies at the same time; or none, and its complaint."""
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


def run_own(measurement: str, copies: int = 1) -> list[dict]:
    """The rows of one of the MEASUREMENTS."""
    rows, complaint = run(sys.executable, __file__, measurement, copies=copies)
    if complaint:
        sys.exit(complaint)
    return rows


def run_other(script: Path, interpreters: list[str]) -> list[dict]:
    """The rows of the first interpreter that has what the script needs, or one without figures."""
    for interpreter in interpreters:
        rows, complaint = run(interpreter, str(script))
        if rows:
            return rows
    return [{"what": script.stem, "complaint": complaint}]


def run_all(interpreters: list[str]) -> list[dict]:
    """All rows once. The first is the one that others are compared with."""
    rows, cores = run_own("all"), os.cpu_count() or 1
    for row in run_own("vector", copies=cores):
        rows.append(row | {"what": f"ArmVectorEnv in {cores} processes", "arms": f"{cores} x 64"})
    return rows + [row for script in sorted(OTHERS.glob("*_*.py")) for row in run_other(script, interpreters)]


def describe(same: list[dict], units: list[dict]) -> list[str]:
    """One line of the table: medians over the rounds of a row and of its ratio to the first row."""
    row, key = same[0], "control_steps_per_second"
    if "complaint" in row:
        return [row["what"], "", "", "", row["complaint"]]
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", action="append", default=[], help="interpreter of another environment")
    interpreters = [sys.executable, *parser.parse_args().python]
    console = Console(width=140)
    with console.status("measuring"):
        rounds = [run_all(interpreters) for _ in range(ROUNDS)]
        (learned,) = run_own("learning")
    table = Table(
        "what", "arms", "muscles", "control step", "control steps/s", "physics steps/s", "ratio", "memory (MB)"
    )
    units = [rows[0] for rows in rounds]
    for same in zip(*rounds, strict=True):
        table.add_row(*describe(list(same), units))
    console.print(
        table, "ratio: of control steps a second to those of the first row; memory: the most so far of the process"
    )
    for error, seconds in zip(ERRORS, learned["seconds"], strict=True):
        console.print(f"{SCENARIO} to a mean error of {error} rad:", f"{seconds:.0f} s" if seconds else "not reached")
    console.print(f"{SCENARIO} to the end: {learned['total']:.0f} s, mean error {learned['error']:.4f} rad")


if __name__ == "__main__":
    if sys.argv[1:] and sys.argv[1] in MEASUREMENTS:
        torch.set_num_threads(1)
        MEASUREMENTS[sys.argv[1]]()
    else:
        main()
