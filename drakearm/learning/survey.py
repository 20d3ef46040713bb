"""Survey: arms that move at random show how much each observation varies, before a training from random weights."""

from collections.abc import Sequence

import numpy as np

from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.learning.input_scaling import InputScaling
from drakearm.task import TrackingTask

ARMS = 32  # or as many as there are tasks


def survey(tasks: Sequence[TrackingTask], action: float, std: float, seed: int) -> InputScaling:
    """The scaling that standardizes the observations of arms whose excitations are drawn from a Gaussian.

    action, std: its mean and standard deviation. Each arm makes one episode. tasks: assigned to the arms round-robin.
    """
    envs = ArmVectorEnv(tasks, max(ARMS, len(tasks)))
    rng = np.random.default_rng(seed)
    observation, _ = envs.reset(seed=seed)
    observations, moving = [observation], np.ones(envs.num_envs, dtype=bool)
    while True:
        excitation = action + std * rng.standard_normal(envs.action_space.shape)
        observation, _, _, truncated, _ = envs.step(excitation.clip(0.0, 1.0))
        moving &= ~truncated
        if not moving.any():
            return InputScaling.of(np.concatenate(observations))
        observations.append(observation[moving])
