"""Runs of a policy on a perturbed arm, of which it knows nothing."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from drakearm.diagrams import MakePolicyLoop, Perturbation
from drakearm.experiments.metrics import STOCHASTIC_RUNS, Act, controller, metrics_of_runs, versions
from drakearm.experiments.provenance import fingerprint
from drakearm.experiments.run_folder import RunFolder
from drakearm.learning import Policy
from drakearm.model.loader import arm_folder
from drakearm.model.recording import Recording
from drakearm.task import TrackingTask

SEED = 0  # of all noise: the same for every policy, so that they can be compared


def run_policy_perturbed(
    task: TrackingTask, policy: Policy | Act, perturbations: Sequence[Perturbation], *, seed: int, runs: int
) -> list[Recording]:
    """Closed-loop runs with the policy's mean excitations on a perturbed arm.

    policy: see `run_policy`. Each run draws the noise of the task's start and of the perturbations from a generator of
    its own. The same seed gives the same runs, and every policy gets the same noise. Raises PolicyFileError if the
    policy is not for this task, TaskError if a perturbation does not fit the arm.
    """
    loop = MakePolicyLoop(task, controller(task, policy), perturbations=perturbations)
    return [loop.Run(np.random.default_rng([seed, run])) for run in range(runs)]


def perturb_step(
    run: RunFolder, perturbations: Sequence[Perturbation], policy_file: Path | None = None
) -> dict[str, Any]:
    """Runs a policy STOCHASTIC_RUNS times on the perturbed arm. Writes perturbed.json and returns its content.

    policy_file: of another policy than that of the run, which then need not be trained. The run's own metrics stay.
    """
    with run.locked():
        file = policy_file or run.existing("policy", "train")
        policy, scenario = Policy.load(file), run.scenario()
        task = run.task(scenario)
        recordings = run_policy_perturbed(task, policy, perturbations, seed=SEED, runs=STOCHASTIC_RUNS)
        metrics = {
            "scenario": scenario.name,
            "perturbations": [{"type": one.type, **asdict(one)} for one in perturbations],  # type: ignore[call-overload]
            "policy": fingerprint(file),
            **metrics_of_runs("perturbed", task, recordings, scenario.success),
            "seed": SEED,
            "versions": versions(),
        }
        with run.replacing("perturb", arm_folder(scenario.arm)) as new:
            recordings[0].save(new.path("perturbed_recording"))
            new.write_record(metrics)
        return metrics
