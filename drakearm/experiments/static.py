"""Runs of a scenario with static optimization, which needs no training."""

import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from drakearm.diagrams import MakeStaticLoop, Perturbation
from drakearm.errors import RunFolderError, shown
from drakearm.experiments.metrics import STOCHASTIC_RUNS, evaluation_metrics, versions
from drakearm.experiments.perturbed import SEED
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.steps import write_evaluation
from drakearm.model.recording import Recording
from drakearm.task import TrackingTask


def run_static(
    task: TrackingTask, perturbations: Sequence[Perturbation] = (), *, seed: int, runs: int
) -> list[Recording]:
    """Closed-loop runs with static optimization, as `run_policy_perturbed` does them with a policy.

    Raises TaskError if a perturbation does not fit the arm.
    """
    loop = MakeStaticLoop(task, perturbations=perturbations)
    return [loop.Run(np.random.default_rng([seed, run])) for run in range(runs)]


def static_step(run: RunFolder) -> dict[str, Any]:
    """Evaluates static optimization in a run folder with a plan, but without a policy.

    Writes the same files as `evaluate_step` and returns the content of metrics.json. The noise is that of the starts.
    Raises RunFolderError if the folder has a policy, because these files would not be those of the policy.
    """
    with run.locked():
        if run.path("policy").exists():
            raise RunFolderError(
                f"{shown(run.folder)} has a policy: expected another folder for the run of static optimization."
            )
        planned = run.read_json("plan", "plan")
        scenario = run.scenario()
        task = run.task(scenario)
        start = time.perf_counter()
        recording, noisy = MakeStaticLoop(task).Run(), run_static(task, seed=SEED, runs=STOCHASTIC_RUNS)
        metrics = {
            "scenario": scenario.name,
            "seed": SEED,
            **evaluation_metrics(task, recording, noisy, scenario.success),
            "plan_seconds": planned["seconds"],
            "evaluation_seconds": time.perf_counter() - start,
            "versions": versions(),
        }
        write_evaluation(run, task, recording, noisy, metrics)
        return metrics
