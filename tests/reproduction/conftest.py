"""Outcomes of trials: static optimization moves the arm, whatever the method of the trial says."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from drakearm.diagrams import MakeStaticLoop
from drakearm.model.recording import Recording
from drakearm.planning.feasibility import muscle_feasibility
from drakearm.reproduction.trial import Method, Outcome, Trial
from drakearm.task import ReferenceStart


@pytest.fixture(scope="session")
def runs(task) -> list[Recording]:
    """Of the task: one without noise, and two from starts with noise."""
    loop = MakeStaticLoop(replace(task, start=ReferenceStart(noise=0.02)))
    return [loop.Run(), *(loop.Run(np.random.default_rng(seed)) for seed in range(2))]


@pytest.fixture(scope="session")
def make_outcome(task, runs):
    """Makes the outcome of a trial, of any movement, with the runs of the task or others."""
    feasibility = muscle_feasibility(task.arm, task.reference)

    def make(trial: Trial, noisy: Sequence[Recording] = runs[1:]) -> Outcome:
        learns = trial.method is not Method.static
        batch = np.arange(1, 41)
        return Outcome(
            trial=trial,
            task=task,
            noise_free=runs[0],
            noisy=tuple(noisy),
            perturbed=tuple(noisy),
            metrics={"noise_free": _metrics(runs[0]), "noisy": _listed([_metrics(run) for run in noisy])},
            learning_curve={"batch": batch, "tracking_error": 0.5 * np.exp(-batch / 10)} if learns else None,
            feasibility=feasibility,
            seconds={"plan": 0.1, "train": 2.0 if learns else 0.0, "evaluate": 0.5},
        )

    return make


def _metrics(run: Recording) -> dict:
    error = np.abs(run.q - run.reference_q)
    return {
        "tracking_error_mean": error.mean(axis=0).tolist(),
        "end_error": error[-1].tolist(),
        "hand_end_error_cm": 0.0,
        "squared_activation": float((run.activation**2).sum(axis=1).mean()),
        "metabolic_energy": float(run.metabolic_power.sum(axis=1).mean()),
    }


def _listed(metrics: list[dict]) -> dict:
    return {name: [each[name] for each in metrics] for name in metrics[0]}
