"""Runs of a policy on a perturbed arm, of which it knows nothing."""

from collections.abc import Sequence

import numpy as np

from drakearm.diagrams import MakePolicyLoop, Perturbation
from drakearm.learning import Policy
from drakearm.model.recording import Recording
from drakearm.task import TrackingTask


def run_policy_perturbed(
    task: TrackingTask, policy: Policy, perturbations: Sequence[Perturbation], *, seed: int, runs: int
) -> list[Recording]:
    """Closed-loop runs with the policy's mean excitations on a perturbed arm.

    Each run draws the noise of the task's start and of the perturbations from a generator of its own. The same seed
    gives the same runs, and every policy gets the same noise. Raises PolicyFileError if the policy is not for this
    task, TaskError if a perturbation does not fit the arm.
    """
    policy.check(task)
    loop = MakePolicyLoop(task, policy.act, perturbations=perturbations)
    return [loop.Run(np.random.default_rng([seed, run])) for run in range(runs)]
