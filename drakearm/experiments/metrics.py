"""How good the runs of a policy are: the numbers of metrics.json."""

from collections.abc import Callable, Sequence
from functools import partial
from importlib.metadata import version
from platform import python_version
from typing import Any

import numpy as np
from scipy.integrate import trapezoid

from drakearm.diagrams import MakePolicyLoop
from drakearm.errors import TaskError, shown
from drakearm.experiments.success import SuccessCriterion
from drakearm.learning import Policy
from drakearm.model import MakeTorqueArm
from drakearm.model.clearance import Clearance
from drakearm.model.recording import Recording
from drakearm.model.skeleton import hand_motion
from drakearm.task import TrackingTask

STOCHASTIC_RUNS = 10
Act = Callable[[np.ndarray], np.ndarray]
_PACKAGES = ("drakearm", "drake", "torch", "numpy", "numba", "gymnasium")


def run_policy(task: TrackingTask, policy: Policy | Act) -> Recording:
    """One closed-loop run with the policy's mean excitations, from the start without noise.

    policy: a `Policy`, or any function from an observation (size,) to excitations (n,). Raises PolicyFileError if the
    policy is not for this task.
    """
    return MakePolicyLoop(task, controller(task, policy)).Run()


def controller(task: TrackingTask, policy: Policy | Act) -> Act:
    """The function from observations to mean excitations. Raises PolicyFileError if a policy is not for this task."""
    if isinstance(policy, Policy):
        policy.check(task)
        return policy.act
    if not callable(policy):
        raise TaskError(f"Found the policy {shown(policy)}: expected a Policy, or a function of the observation.")
    return policy


def run_policy_stochastic(task: TrackingTask, policy: Policy, seed: int) -> list[Recording]:
    """STOCHASTIC_RUNS closed-loop runs with excitations that are sampled from the policy, each from a random start.

    Raises PolicyFileError if the policy is not for this task, TaskError if it is no `Policy`.
    """
    if not isinstance(policy, Policy):
        raise TaskError(f"Found the policy {shown(policy)}: expected a Policy, which can sample its excitations.")
    policy.check(task)
    generators = [np.random.default_rng([seed, run]) for run in range(STOCHASTIC_RUNS)]
    return [MakePolicyLoop(task, partial(policy.act, rng=rng)).Run(rng) for rng in generators]


def run_metrics(task: TrackingTask, recording: Recording, criteria: Sequence[SuccessCriterion]) -> dict[str, Any]:
    """What one run of a task is like, whatever moved the arm. Errors are those of the joints (rad, one per joint).

    tracking_error_mean, tracking_error_max, end_error. hand_end_error_cm: from the end of the reference.
    hand_end_speed: m/s. squared_activation: s, sum over the muscles, integrated over time. metabolic_energy: J, of all
    muscles. success: whether the run meets each criterion, by its name. If the task has an obstacle and the arm has an
    outline: clearance_cm and PART_clearance_cm, the least distance of the arm, and of each part, at any time.
    """
    error = np.abs(recording.q - recording.reference_q)
    plant = MakeTorqueArm(task.arm)
    goal, _ = hand_motion(plant, task.arm, task.reference.q[-1:], task.reference.v[-1:])
    metrics: dict[str, Any] = {
        "tracking_error_mean": error.mean(axis=0).tolist(),
        "tracking_error_max": error.max(axis=0).tolist(),
        "end_error": error[-1].tolist(),
        "hand_end_error_cm": 100.0 * float(np.linalg.norm(recording.p_WH[-1] - goal[0])),
        "hand_end_speed": float(recording.hand_speed[-1]),
        "squared_activation": float(trapezoid((recording.activation**2).sum(axis=1), recording.t)),
        "metabolic_energy": float(trapezoid(recording.metabolic_power.sum(axis=1), recording.t)),
    }
    if task.obstacle is not None and task.arm.outline:
        clearance = Clearance(plant, task.arm, task.obstacle)
        distances = clearance.along(recording.t, recording.q, recording.v)[1].min(axis=0)
        metrics["clearance_cm"] = 100.0 * float(distances.min())
        for part, distance in zip(task.arm.outline, distances, strict=True):
            metrics[f"{part.name}_clearance_cm"] = 100.0 * float(distance)
    return metrics | {"success": {each.name: each(task, recording, metrics) for each in criteria}}


def evaluation_metrics(
    task: TrackingTask, noise_free: Recording, noisy: Sequence[Recording], criteria: Sequence[SuccessCriterion]
) -> dict[str, Any]:
    """The metrics of the run without noise, and of those with noise, as `metrics_of_runs` has them."""
    return {
        "joints": list(task.arm.coordinates),
        "noise_free": run_metrics(task, noise_free, criteria),
        **metrics_of_runs("noisy", task, noisy, criteria),
    }


def metrics_of_runs(
    kind: str, task: TrackingTask, runs: Sequence[Recording], criteria: Sequence[SuccessCriterion]
) -> dict[str, Any]:
    """Under the name of the kind of runs, a list per quantity with one value per run; and the share of successes."""
    each = [run_metrics(task, run, criteria) for run in runs]
    return {
        kind: {name: [metrics[name] for metrics in each] for name in each[0]},
        "success_rate": {c.name: float(np.mean([metrics["success"][c.name] for metrics in each])) for c in criteria},
    }


def versions() -> dict[str, str]:
    """Versions of Python and of the packages on which the numbers depend."""
    return {"python": python_version()} | {package: version(package) for package in _PACKAGES}
