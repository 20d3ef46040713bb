"""How well a policy makes the movements of a library: the errors of each, and their percentiles."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drakearm.learning import ArmVectorEnv
from drakearm.learning.expert import StaticExpert
from drakearm.model import MakeTorqueArm
from drakearm.model.skeleton import hand_motion
from drakearm.task import TrackingTask
from drakearm.task.starts import ReferenceStart

REACHED = 1.0  # cm from the target, within which the hand has reached it
Act = Callable[[np.ndarray], np.ndarray]


class Errors(NamedTuple):
    """Errors of K movements."""

    mean: np.ndarray  # (K,) rad, mean over the movement, of the worse joint
    hand: np.ndarray  # (K,) cm, distance of the hand from the target at the end

    def summary(self) -> dict[str, float]:
        """Medians, 95th percentiles and the largest errors, and the share of the movements that reach the target."""
        return {
            "mean_error_median_rad": float(np.median(self.mean)),
            "mean_error_95_rad": float(np.percentile(self.mean, 95)),
            "mean_error_worst_rad": float(self.mean.max()),
            "hand_end_median_cm": float(np.median(self.hand)),
            "hand_end_95_cm": float(np.percentile(self.hand, 95)),
            "hand_end_worst_cm": float(self.hand.max()),
            "share_within_1_cm": float(np.mean(self.hand <= REACHED)),
        }


def held_out_errors(tasks: Sequence[TrackingTask], act: Act | None, *, random: bool = False, seed: int = 0) -> Errors:
    """The errors (K,) in one run of each of K tasks, without exploration: `mean` in rad, `hand` in cm.

    act: a policy, from observations (K, size) to excitations (K, n); None: static optimization that is told the load.
    random: whether starts have their noise and the tasks their randomization; without it, both are left out. seed: of
    that.
    """
    if not random:
        tasks = [replace(task, start=ReferenceStart(), randomization=()) for task in tasks]
    mean, last = carry_out(tasks, act, seed)
    plant, arm = MakeTorqueArm(tasks[0].arm), tasks[0].arm
    goals = np.array([task.reference.q[-1] for task in tasks])
    p_WH, p_WG = (hand_motion(plant, arm, q, np.zeros_like(q))[0] for q in (last, goals))
    return Errors(mean.max(axis=1), 100.0 * np.linalg.norm(p_WH - p_WG, axis=1))


def carry_out(tasks: Sequence[TrackingTask], act: Act | None, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """One run of each task: the mean errors (K, n_q), and the angles at the end (K, n_q), rad. act: as above."""
    envs = ArmVectorEnv(tasks, len(tasks))
    expert = StaticExpert(envs) if act is None else None
    observation, info = envs.reset(seed=seed)
    total = np.zeros((len(tasks), len(tasks[0].arm.coordinates)))
    moving, last = np.ones(len(tasks), dtype=bool), np.zeros_like(total)
    steps = np.zeros(len(tasks))
    while moving.any():
        action = expert.act(info["arm_state"], info["activation"]) if expert else act(observation)  # type: ignore[misc]
        observation, _, _, truncated, info = envs.step(action)
        total[moving] += np.abs(info["tracking_error"][moving])
        last[moving] = info["arm_state"][moving, : total.shape[1]]
        steps += moving
        moving &= ~truncated
    return total / steps[:, None], last
