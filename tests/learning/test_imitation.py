"""Imitation: the expert tracks a movement that the muscles can follow, and an actor learns it in a few rounds."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from drakearm.learning import ArmVectorEnv, imitate
from drakearm.learning.expert import StaticExpert
from drakearm.learning.networks import Actor, Critic, policy_of


def errors(envs: ArmVectorEnv, act) -> np.ndarray:
    """Mean absolute tracking errors (n_q,) of arm 0 over its episode; act: from observation and info to actions."""
    observation, info = envs.reset(seed=0)
    found, over = [], False
    while not over:
        observation, _, _, truncated, info = envs.step(act(observation, info))
        found.append(np.abs(info["tracking_error"][0]))
        over = truncated[0]
    return np.mean(found, axis=0)


@pytest.mark.parametrize("load", [0.0, 2.0])
def test_the_expert_tracks_a_movement_that_the_muscles_can_follow(task, load):
    task = replace(task, load_mass=load)
    envs = ArmVectorEnv(task, 2)
    expert = StaticExpert(envs)
    act = lambda observation, info: expert.act(info["arm_state"], info["activation"])  # noqa: E731
    assert np.all(errors(envs, act) < 0.015)


@pytest.mark.slow
def test_an_actor_learns_to_track_by_imitation(task):
    actor, rounds = Actor(58, 14), []
    envs = ArmVectorEnv(task, 2)
    untrained = policy_of(actor, Critic(58), np.zeros(14), np.ones(14), {})
    assert errors(envs, lambda observation, info: untrained.act(observation)).max() > 0.2
    scaling = imitate(actor, [task], 3, seed=0, on_round=rounds.append)
    policy = policy_of(actor, Critic(58), np.zeros(14), np.ones(14), {}, scaling)
    assert errors(envs, lambda observation, info: policy.act(observation)).max() < 0.02
    assert rounds == [1, 2, 3]


def test_the_same_seed_gives_the_same_actor(task):
    short = replace(task, reference=replace(task.reference, **{n: getattr(task.reference, n)[:6] for n in "tqva"}))
    weights = []
    for seed in (0, 0, 1):
        actor = Actor(58, 14, (16,))
        imitate(actor, [short], 2, seed)
        weights.append(torch.cat([p.detach().ravel() for p in actor.parameters()]))
    torch.testing.assert_close(weights[0], weights[1], rtol=0.0, atol=0.0)
    assert (weights[0] != weights[2]).any()


@pytest.mark.parametrize("arms", [1, 3])
def test_an_actor_can_imitate_several_tasks(task, arms):
    """Also if there are more tasks than arms."""
    short = replace(task, reference=replace(task.reference, **{n: getattr(task.reference, n)[:6] for n in "tqva"}))
    actor = Actor(58, 14, (16,))
    before = actor.mean[0].weight.clone()
    imitate(actor, [short, replace(short, load_mass=1.0)], 1, seed=0, arms=arms)
    assert (actor.mean[0].weight != before).any()
