"""Rehearsal: an expert that has rehearsed a movement follows it more exactly."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.learning import ArmVectorEnv
from drakearm.learning.expert import StaticExpert
from drakearm.learning.rehearsal import rehearse


def mean_errors(tasks, aims):
    """The mean absolute errors (K, n_q) of an expert that moves one arm per task."""
    envs = ArmVectorEnv(tasks, len(tasks))
    expert = StaticExpert(envs, aims)
    _, info = envs.reset(seed=0)
    errors = []
    for _ in tasks[0].reference.t[1:]:
        action = expert.act(info["arm_state"], info["activation"])
        _, _, _, _, info = envs.step(action)
        errors.append(np.abs(info["tracking_error"]))
    return np.mean(errors, axis=0)


@pytest.fixture(scope="module")
def exact_tasks(task):
    """A movement without noise at the start, with and without a load."""
    exact = replace(task, start=replace(task.start, noise=0.0))
    return [exact, replace(exact, load_mass=1.0)]


def test_an_expert_that_rehearsed_errs_much_less(exact_tasks):
    before, after = mean_errors(exact_tasks, None), mean_errors(exact_tasks, rehearse(exact_tasks))
    assert np.all(after.max(axis=1) < 0.25 * before.max(axis=1))
    assert after.max() < 0.002


def test_noise_at_the_start_does_not_disturb_the_rehearsal(task, exact_tasks):
    for noisy, exact in zip(rehearse([task]), rehearse(exact_tasks[:1]), strict=True):
        np.testing.assert_array_equal(noisy.q, exact.q)


def test_a_movement_that_is_too_heavy_is_not_made_worse(exact_tasks):
    heavy = [replace(exact_tasks[0], load_mass=15.0)]
    before, after = mean_errors(heavy, None), mean_errors(heavy, rehearse(heavy))
    assert (after**2).sum() <= 1.2 * (before**2).sum()
