"""The transitions that are collected from vector environments are true ones, without resets."""

import numpy as np
import pytest
import torch

from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.networks import Actor
from drakearm.learning.rollout import Collector
from tests.small_environments import NEXT_STEP, SAME_STEP, Counter, vectorize


def collect(envs, steps, batches=1):
    collector = Collector(envs, steps, 0, InputScaling.none(1))
    actor = Actor(1, 1, (4,), initial_action=0.0, initial_std=5.0)
    generator = torch.Generator()
    return [collector.collect(actor, generator, batch) for batch in range(1, batches + 1)]


@pytest.mark.parametrize("terminates", [False, True])
@pytest.mark.parametrize("mode", [NEXT_STEP, SAME_STEP])
def test_a_batch_holds_the_true_successors_and_no_resets(mode, terminates):
    envs = vectorize(Counter, mode=mode, length=5, terminates=terminates)
    rollouts = collect(envs, steps=8, batches=3)  # some episodes continue in the next batch
    valid = np.concatenate([rollout.valid for rollout in rollouts])
    before = np.concatenate([rollout.observations for rollout in rollouts])[valid]
    after = np.concatenate([rollout.successors for rollout in rollouts])[valid]
    ended = np.concatenate([rollout.ended for rollout in rollouts])[valid]
    terminated = np.concatenate([rollout.terminated for rollout in rollouts])[valid]

    np.testing.assert_array_equal(after, before + 1)
    np.testing.assert_array_equal(ended, after[:, 0] == 5)
    np.testing.assert_array_equal(terminated, ended & terminates)
    assert valid.sum() == 4 * (20 if mode == NEXT_STEP else 24)  # 5 of 6 steps, or all
    returns = [value for rollout in rollouts for value in rollout.episode_returns]
    assert returns == [5.0] * 16


def test_log_probs_are_those_of_the_actions():
    actor = Actor(1, 1, (4,), initial_std=0.3)
    rollout = Collector(vectorize(Counter), 8, 0, InputScaling.none(1)).collect(actor, torch.Generator(), batch=1)
    with torch.no_grad():
        expected = actor.log_prob(rollout.observations, rollout.actions)
    torch.testing.assert_close(rollout.log_probs, expected, rtol=1e-4, atol=1e-5)


def test_actions_are_kept_as_sampled_and_clipped_for_the_environment():
    (rollout,) = collect(vectorize(Counter), steps=8)  # Counter asserts that they are in bounds
    assert rollout.actions.abs().max() > 1


class Erring(Counter):
    """Reports minus the number of steps so far as its tracking error, and 1000 at a reset."""

    def reset(self, *, seed=None, options=None):
        observation, _ = super().reset(seed=seed)
        return observation, {"tracking_error": np.array([1000.0])}

    def step(self, action):
        *rest, _ = super().step(action)
        return *rest, {"tracking_error": np.array([-float(self.count)])}


@pytest.mark.parametrize("mode", [NEXT_STEP, SAME_STEP])
def test_tracking_error_is_that_of_transitions_and_not_of_resets(mode):
    envs = vectorize(Erring, n=2, mode=mode, length=4)
    steps = 4 if mode is SAME_STEP else 5  # with the step that only resets
    rollout = Collector(envs, steps, 0, InputScaling.none(1)).collect(Actor(1, 1), torch.Generator(), batch=1)
    assert rollout.tracking_error == (1 + 2 + 3 + 4) / 4
