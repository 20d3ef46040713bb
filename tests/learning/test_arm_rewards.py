"""The rewards of a user: one number per arm, in both environments."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import TaskError
from drakearm.experiments import make_task_env
from drakearm.learning import ArmVectorEnv
from drakearm.task import Reward


def reward_of(calc):
    """A reward, named Bad, that computes a function of the state and the reference."""
    attributes = {"type": "", "reads": ("arm_state", "reference"), "__call__": lambda self, s, r: calc(s, r)}
    return type("Bad", (Reward,), attributes)()


@pytest.mark.parametrize(
    ("calc", "of_many", "of_one"),
    [
        (lambda s, r: -((s - r) ** 2).sum(), r"the shape \(\)", None),
        (lambda s, r: -((s - r) ** 2), r"the shape \(8, 4\)", r"the shape \(4,\)"),
        (lambda s, r: -((s - r) ** 2).sum(axis=-1, keepdims=True), r"the shape \(8, 1\)", r"the shape \(1,\)"),
        (lambda s, r: None, "None", "None"),
    ],
)
def test_a_reward_that_is_not_one_number_per_arm_is_refused(task, calc, of_many, of_one):
    bad = replace(task, reward=reward_of(calc))
    for tasks in (bad, [bad, bad]):
        envs = ArmVectorEnv(tasks, 8)
        envs.reset(seed=0)
        with pytest.raises(TaskError, match=rf"The reward Bad computed {of_many}: expected \(8,\), one number per arm"):
            envs.step(np.zeros((8, 14)))
    mixed = ArmVectorEnv([bad, task], 8)
    mixed.reset(seed=0)
    with pytest.raises(TaskError, match=r"The reward Bad .*: expected \(4,\), one number per arm"):
        mixed.step(np.zeros((8, 14)))
    env = make_task_env(bad)
    env.reset(seed=0)
    if of_one is None:
        assert np.isfinite(env.step(np.zeros(14))[1])
    else:
        with pytest.raises(TaskError, match=f"The reward Bad computed {of_one}: expected a single number"):
            env.step(np.zeros(14))


def test_a_reward_of_whole_numbers_is_one(task):
    within = replace(task, reward=reward_of(lambda s, r: np.abs(s - r).max(axis=-1) < 0.5))
    envs = ArmVectorEnv(within, 3)
    envs.reset(seed=0)
    np.testing.assert_array_equal(envs.step(np.zeros((3, 14)))[1], 1.0)
