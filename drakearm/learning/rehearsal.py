"""Rehearsal: the expert repeats a movement and corrects what it aims at, until the arm follows the reference.

Static optimization neglects that forces lag behind activations while tendons stretch, so the arm errs in the same way
in every repetition. Iterative learning control (Arimoto, Kawamura and Miyazaki 1984) removes such errors: the expert
aims at the reference minus the errors of all earlier repetitions.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.learning.expert import STIFFNESS, Aim, StaticExpert
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.task import Start, StartState, TrackingTask

REPETITIONS = 8
_LEAD = 2  # control steps from an excitation to the movement that it causes
_SMOOTHING = 1.0  # control steps, standard deviation: errors that change faster are not corrected


@dataclass(frozen=True)
class _WithoutNoise(Start):
    """The start of a task without its noise."""

    start: Start

    def __call__(self, reference: Reference, rng: np.random.Generator | None) -> StartState:
        return self.start(reference, None)


def rehearse(tasks: Sequence[TrackingTask], stiffness: float = STIFFNESS) -> list[Aim]:
    """What the expert aims at in each task: of all repetitions, the aim that brought the largest sum of rewards.

    stiffness: 1/s^2, of the expert's feedback.
    """
    tasks = [replace(task, start=_WithoutNoise(task.start), randomization=()) for task in tasks]
    envs = ArmVectorEnv(tasks, len(tasks))
    expert = StaticExpert(envs, stiffness=stiffness)
    best, most = [*expert.aims], np.full(len(tasks), -np.inf)
    corrections = [np.zeros_like(task.reference.q) for task in tasks]
    for _ in range(REPETITIONS):
        errors, returns = _repeat(envs, expert)
        for k in np.flatnonzero(returns > most).tolist():
            best[k], most[k] = expert.aims[k], returns[k]
        corrections = [
            correction - np.vstack([error[_LEAD:], np.repeat(error[-1:], _LEAD, axis=0)])
            for correction, error in zip(corrections, errors, strict=True)
        ]
        expert.aims = [_aim(task.reference, c) for task, c in zip(tasks, corrections, strict=True)]
    return best


def _repeat(envs: ArmVectorEnv, expert: StaticExpert) -> tuple[list[np.ndarray], np.ndarray]:
    """The tracking errors (N, n_q) of each arm at the samples of its reference, and the sums of rewards (arms,)."""
    _, info = envs.reset()
    errors = [np.zeros_like(aim.q) for aim in expert.aims]
    returns, moving = np.zeros(envs.num_envs), np.ones(envs.num_envs, dtype=bool)
    while moving.any():
        step = envs.reference_step
        _, reward, _, truncated, info = envs.step(expert.act(info["arm_state"], info["activation"]))
        returns += reward * moving
        for k in np.flatnonzero(moving):
            errors[k][step[k] + 1] = info["tracking_error"][k]
        moving &= ~truncated
    return errors, returns


def _aim(reference: Reference, correction: np.ndarray) -> Aim:
    """The reference plus a correction of its angles (N, n_q), rad, which is smoothed. Its accelerations are kept."""
    smooth = gaussian_filter1d(correction, _SMOOTHING, axis=0, mode="nearest")
    return Aim(reference.q + smooth, reference.v + np.gradient(smooth, CONTROL_STEP, axis=0), reference.a)
