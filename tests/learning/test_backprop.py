"""The gradients written by hand equal those of autograd, and learning from a batch follows them."""

import numpy as np
import pytest
import torch

from drakearm.errors import TrainingError
from drakearm.learning.backprop import Backprop, flat_weights
from drakearm.learning.learners import ActorLearner, Batch, CriticLearner
from drakearm.learning.networks import Actor, Critic

ROWS = 50


def batch(actor: Actor, **changes) -> Batch:
    generator = torch.Generator().manual_seed(0)
    observations = torch.randn(ROWS, 6, generator=generator)
    actions = torch.randn(ROWS, 3, generator=generator) * 0.5
    with torch.no_grad():  # as if another policy had taken the actions, so that some ratios are clipped
        log_probs = actor.log_prob(observations, actions) + 0.3 * torch.randn(ROWS, generator=generator)
    fields = {
        "observations": observations,
        "actions": actions,
        "log_probs": log_probs,
        "advantages": torch.randn(ROWS, generator=generator),
        "returns": torch.randn(ROWS, generator=generator),
        "orders": [torch.arange(ROWS)],
        "minibatches": 1,
        "number": 1,
    }
    return Batch(**(fields | changes))


@pytest.mark.parametrize("network", [Actor(6, 3, (8, 5)).mean, Critic(6, (8, 5, 4)).value])
@pytest.mark.parametrize("rows", [1, 7, ROWS])
def test_forward_and_backward_pass_equal_those_of_autograd(network, rows):
    inputs = torch.randn(rows, 6)
    weights = torch.randn_like(network(inputs))
    flat_weights(network)
    network.zero_grad(set_to_none=False)
    (network(inputs) * weights).sum().backward()
    expected = [parameter.grad.clone() for parameter in network.parameters()]
    network.zero_grad(set_to_none=False)
    backprop = Backprop(network)
    torch.testing.assert_close(backprop.forward(inputs), network(inputs).detach())
    backprop.backward(weights)
    for parameter, gradient in zip(network.parameters(), expected, strict=True):
        torch.testing.assert_close(parameter.grad, gradient, rtol=1e-4, atol=1e-5)


def test_the_actors_gradient_is_that_of_the_clipped_objective():
    actor, clip = Actor(6, 3, (8, 5)), 0.2
    data = batch(actor)
    learner = ActorLearner(actor, max_grad_norm=1e9, clip=clip)
    ratio = torch.exp(actor.log_prob(data.observations, data.actions) - data.log_probs)
    clipped = ratio.clamp(1 - clip, 1 + clip)
    loss = -torch.minimum(ratio * data.advantages, clipped * data.advantages).mean()
    expected = torch.autograd.grad(loss, list(actor.parameters()))
    learner.set_learning_rate(0.0)
    diagnostics = learner.learn(data)
    for parameter, gradient in zip(actor.parameters(), expected, strict=True):
        torch.testing.assert_close(parameter.grad, gradient, rtol=1e-4, atol=1e-6)
    assert diagnostics["policy_loss"] == pytest.approx(loss.item(), rel=1e-5)
    assert 0.1 < diagnostics["clip_fraction"] < 0.9


def test_a_scheduled_standard_deviation_is_not_learned():
    actor = Actor(6, 3, (8,), learns_std=False)
    learner = ActorLearner(actor, max_grad_norm=1.0, clip=0.2)
    learner.set_learning_rate(0.1)
    before = actor.log_std.clone()
    learner.learn(batch(actor))
    torch.testing.assert_close(actor.log_std, before)


def test_the_critic_learns_the_returns():
    critic = Critic(6, (32,))
    learner = CriticLearner(critic, max_grad_norm=10.0, weight=0.5)
    learner.set_learning_rate(0.01)
    data = batch(Actor(6, 3, (4,)), orders=[torch.arange(ROWS)] * 500)
    learner.learn(data)
    with torch.no_grad():
        assert (critic(data.observations) - data.returns).square().mean() < 0.1 * data.returns.var()


def test_a_gradient_that_is_not_finite_is_refused():
    actor = Actor(6, 3, (4,))
    learner = ActorLearner(actor, max_grad_norm=1.0, clip=0.2)
    with pytest.raises(TrainingError, match="not finite in batch 1"):
        learner.learn(batch(actor, advantages=torch.full((ROWS,), np.nan)))
