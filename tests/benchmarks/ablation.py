"""What each part of learning is worth: the default without it, over five seeds.

`python tests/benchmarks/ablation.py` prints a table: mean errors without noise, medians and worst of the seeds.
"""

import time
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

from drakearm.diagrams import TrackingTask
from drakearm.experiments.metrics import run_policy
from drakearm.experiments.scenario import load_scenario
from drakearm.learning import PAPER, ArmVectorEnv, PpoSettings, imitate, train
from drakearm.model import load_arm
from drakearm.planning import plan

SCENARIO = "timing-0.7s"
SEEDS = range(5)
DEFAULT = PpoSettings()
VARIANTS: dict[str, tuple[PpoSettings, str]] = {
    "default": (DEFAULT, "full"),
    "imitation alone": (replace(DEFAULT, batches=1, learning_rate=1e-12), "full"),
    "learning rate falls instead of holding the divergence": (
        replace(DEFAULT, target_kl=None, learning_rate=1e-4),
        "full",
    ),
    "exploration is learned instead of fading": (replace(DEFAULT, final_std=None), "full"),
    "no imitation: the paper's settings, full observation": (PAPER, "full"),
    "preset paper": (PAPER, "paper"),
}


def measure(task: TrackingTask, settings: PpoSettings, seed: int) -> tuple[np.ndarray, float]:
    """The mean error of each joint (n_q,), rad, and the seconds of training."""
    envs, began = ArmVectorEnv(task, settings.environments), time.perf_counter()

    def prepare(actor):
        imitate(actor, [task], settings.imitation_rounds, seed)

    policy = train(envs, settings, seed=seed, metadata={}, prepare=prepare if settings.imitation_rounds else None)
    seconds = time.perf_counter() - began
    recording = run_policy(task, policy)
    return np.abs(recording.q - recording.reference_q).mean(axis=0), seconds


def main() -> None:
    scenario = load_scenario(SCENARIO)
    task = scenario.task(plan(load_arm(scenario.arm), scenario.movement).reference)
    table = Table("variant", "shoulder, median", "elbow, median", "worst joint and seed", "training (s), median")
    console = Console(width=130)
    for name, (settings, observation) in VARIANTS.items():
        measured = [measure(replace(task, observation=observation), settings, seed) for seed in SEEDS]
        errors = np.array([error for error, _ in measured])
        seconds = np.median([time for _, time in measured])
        shoulder, elbow = np.median(errors, axis=0)
        row = (name, f"{shoulder:.4f}", f"{elbow:.4f}", f"{errors.max():.4f}", f"{seconds:.0f}")
        console.print(*row, sep=" | ")
        table.add_row(*row)
    console.print(table)


if __name__ == "__main__":
    main()
