"""How well a policy follows its reference: the numbers of metrics.json."""

from collections.abc import Sequence
from functools import partial
from importlib.metadata import version
from platform import python_version
from typing import Any

import numpy as np

from drakearm.diagrams import MakePolicyLoop
from drakearm.learning import Policy
from drakearm.model.recording import Recording
from drakearm.task import TrackingTask

STOCHASTIC_RUNS = 10
SUCCESS = 0.1  # rad: a run is a success if the mean error of every joint is smaller
_PACKAGES = ("drakearm", "drake", "torch", "numpy", "numba", "gymnasium")


def run_policy(task: TrackingTask, policy: Policy) -> Recording:
    """One closed-loop run with the policy's mean excitations, from the start without noise.

    Raises PolicyFileError if the policy is not for this task.
    """
    policy.check(task)
    return MakePolicyLoop(task, policy.act).Run()


def run_policy_stochastic(task: TrackingTask, policy: Policy, seed: int) -> list[Recording]:
    """STOCHASTIC_RUNS closed-loop runs with excitations that are sampled from the policy, each from a random start.

    Raises PolicyFileError if the policy is not for this task.
    """
    policy.check(task)
    generators = [np.random.default_rng([seed, run]) for run in range(STOCHASTIC_RUNS)]
    return [MakePolicyLoop(task, partial(policy.act, rng=rng)).Run(rng) for rng in generators]


def tracking_metrics(deterministic: Recording, stochastic: Sequence[Recording]) -> dict[str, Any]:
    """The tracking errors, rad, one per joint, of the deterministic run and of the stochastic runs."""
    error = _error(deterministic)
    means = np.array([_error(run).mean(axis=0) for run in stochastic])
    return {
        "tracking_error_mean": error.mean(axis=0).tolist(),
        "tracking_error_max": error.max(axis=0).tolist(),
        "end_error": error[-1].tolist(),
        "success_rate": float((means.max(axis=1) < SUCCESS).mean()),
        "stochastic_runs": {
            "tracking_error_mean": means.tolist(),
            "end_error": [_error(run)[-1].tolist() for run in stochastic],
        },
    }


def versions() -> dict[str, str]:
    """Versions of Python and of the packages on which the numbers depend."""
    return {"python": python_version()} | {package: version(package) for package in _PACKAGES}


def _error(recording: Recording) -> np.ndarray:
    return np.abs(recording.q - recording.reference_q)
