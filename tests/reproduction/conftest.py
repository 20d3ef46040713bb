"""Outcomes of trials: static optimization moves the arm, whatever the method of the trial says."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from drakearm.diagrams import MakeStaticLoop
from drakearm.experiments.metrics import evaluation_metrics
from drakearm.experiments.success import FOLLOWS
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
            metrics=evaluation_metrics(task, runs[0], noisy, [FOLLOWS]),
            learning_curve={"batch": batch, "tracking_error": 0.5 * np.exp(-batch / 10)} if learns else None,
            feasibility=feasibility,
            seconds={"plan": 0.1, "train": 2.0 if learns else 0.0, "evaluate": 0.5},
        )

    return make
