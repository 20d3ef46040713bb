"""Networks of a user's own: any module of PyTorch learns, acts, is kept in a file, and is refused with a reason."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import nn

from drakearm.errors import PolicyFileError, TrainingError
from drakearm.learning import train
from drakearm.learning.backprop import Backprop, flat_weights, is_mlp
from drakearm.learning.module_policy import ModulePolicy
from drakearm.learning.networks import Actor, Critic
from drakearm.learning.passes import Autograd, passes
from drakearm.learning.policy import Policy
from tests.learning.test_ppo import SMALL
from tests.small_environments import SAME_STEP, Tracker, tracking_return, vectorize

SETTINGS = replace(SMALL, environments=8, steps=40, epochs=8, gamma=0.9)


class Residual(nn.Module):
    """A network that is no MLP: a linear map beside two layers."""

    def __init__(self, inputs, outputs):
        super().__init__()
        self.straight = nn.Linear(inputs, outputs)
        self.bent = nn.Sequential(nn.LayerNorm(inputs), nn.Linear(inputs, 16), nn.GELU(), nn.Linear(16, outputs))
        for last in (self.straight, self.bent[-1]):
            nn.init.normal_(last.weight, std=0.01)  # the first actions are small, so that the point stays near
            nn.init.zeros_(last.bias)

    def forward(self, x):
        return self.straight(x) + self.bent(x)


class Remembers(nn.Module):
    """A recurrent network that keeps its state from call to call."""

    def __init__(self, inputs, outputs):
        super().__init__()
        self.recurrent, self.last, self.state = nn.GRU(inputs, 16), nn.Linear(16, outputs), None

    def forward(self, x):
        outputs, self.state = self.recurrent(x[None], self.state)
        return self.last(outputs[0])


def dropout(inputs, outputs):
    return nn.Sequential(nn.Linear(inputs, 16), nn.Dropout(0.5), nn.Linear(16, outputs))


def normalized(inputs):
    return nn.Sequential(nn.BatchNorm1d(inputs), nn.Linear(inputs, 1))


def networks(n_observations, n_actions):
    return Residual(n_observations, n_actions), Residual(n_observations, 1)


def learn(batches, seed=1, **arguments):
    settings = replace(SETTINGS, batches=batches, learning_rate=3e-3, critic_learning_rate=3e-3)
    envs = vectorize(Tracker, n=8, mode=SAME_STEP)
    return train(envs, settings, seed=seed, metadata={"name": "own"}, networks=networks, **arguments)


def test_any_module_learns_to_track():
    reports = []
    policy = learn(40, on_batch=reports.append)
    assert isinstance(policy, ModulePolicy)
    assert reports[-1].tracking_error < 0.15 < reports[0].tracking_error
    assert tracking_return(policy) > -0.2


def test_the_same_seed_gives_the_same_policy_whatever_the_global_generator_is():
    observation = np.random.default_rng(0).normal(size=(5, 2))
    torch.manual_seed(3)
    first = learn(2).act(observation)
    torch.manual_seed(4)
    np.testing.assert_array_equal(learn(2).act(observation), first)
    assert (learn(2, seed=2).act(observation) != first).any()


def test_a_file_holds_the_policy(tmp_path):
    file, observation = tmp_path / "own.safetensors", np.random.default_rng(0).normal(size=(3, 4, 2))
    policy = learn(2, checkpoint_path=file)
    loaded = ModulePolicy.load(file, networks)
    np.testing.assert_array_equal(loaded.act(observation), policy.act(observation))
    np.testing.assert_array_equal(loaded.value(observation), policy.value(observation))
    assert loaded.value(observation).shape == (3, 4) and loaded.metadata == {"name": "own"}
    sampled = [loaded.act(observation, np.random.default_rng(seed)) for seed in (0, 0, 1)]
    assert (sampled[0] == sampled[1]).all() and (sampled[0] != sampled[2]).any()
    with pytest.raises(
        PolicyFileError, match=r"not a drakearm policy .* it is a ModulePolicy, which `ModulePolicy.load"
    ):
        Policy.load(file)
    with pytest.raises(PolicyFileError, match="the function that makes the networks"):
        ModulePolicy.load(file)
    with pytest.raises(PolicyFileError, match="weights of other networks"):
        ModulePolicy.load(file, lambda n, m: (nn.Linear(n, m), nn.Linear(n, 1)))
    with pytest.raises(PolicyFileError, match="no file of a policy"):
        ModulePolicy.load(tmp_path / "nothing", networks)


@pytest.mark.parametrize(
    ("own", "reason"),
    [
        (lambda n, m: (nn.Linear(n, m + 1), nn.Linear(n, 1)), r"actor makes outputs of shape \(2, 2\).*\(2, 1\)"),
        (lambda n, m: (nn.Linear(n, m), nn.Linear(n, 2)), r"critic makes outputs of shape \(2, 2\)"),
        (lambda n, m: (nn.Linear(n + 1, m), nn.Linear(n, 1)), "actor cannot take 2 observations of length 2"),
        (
            lambda n, m: (Remembers(n, m), nn.Linear(n, 1)),
            "actor computes different outputs .* no memory between steps",
        ),
        (lambda n, m: (dropout(n, m), nn.Linear(n, 1)), "actor computes something else in training mode .* dropout"),
        (lambda n, m: (nn.Linear(n, m), normalized(n)), "critic computes something else in training mode .* dropout"),
    ],
)
def test_networks_that_do_not_fit_are_refused(own, reason):
    with pytest.raises(TrainingError, match=reason):
        train(vectorize(Tracker, n=8), SETTINGS, seed=0, metadata={}, networks=own)


def test_an_unknown_device_is_refused():
    with pytest.raises(TrainingError, match="no device 'abacus'"):
        learn(1, device="abacus")
    assert isinstance(learn(1, device="cpu"), ModulePolicy)


def test_only_mlps_have_passes_by_hand():
    assert is_mlp(Actor(3, 2).mean) and is_mlp(Critic(3).value)
    for other in (Residual(3, 2), nn.Sequential(nn.Linear(3, 4), nn.ReLU(), nn.Linear(4, 1)), nn.Linear(3, 1)):
        assert not is_mlp(other)
    assert isinstance(passes(Critic(3).value), Backprop) and isinstance(passes(Residual(3, 2)), Autograd)


def test_autograds_passes_are_those_by_hand():
    torch.manual_seed(0)
    network, inputs, by_outputs = Actor(6, 3, (8, 5)).mean, torch.randn(7, 6), torch.randn(7, 3)
    flat = flat_weights(network)
    found = []
    for one in (Backprop(network), Autograd(network), Autograd(network)):  # the second time, gradients are not 0 before
        outputs = one.forward(inputs).clone()
        one.backward(by_outputs)
        found.append((outputs, flat.grad.clone()))
    for outputs, gradient in found[1:]:
        torch.testing.assert_close(outputs, found[0][0])
        torch.testing.assert_close(gradient, found[0][1], rtol=1e-4, atol=1e-5)


def test_a_training_can_start_from_a_policy_with_own_networks():
    first = learn(2)
    observation = np.random.default_rng(0).normal(size=(5, 2))
    settings = replace(SETTINGS, batches=1, critic_share=1.0)
    envs = vectorize(Tracker, n=8)
    warm = train(envs, settings, seed=9, networks=networks, initial_policy=first)
    np.testing.assert_array_equal(warm.act(observation), first.act(observation))
    with pytest.raises(TrainingError, match="The actor of the initial policy has the weights"):
        train(envs, settings, seed=9, initial_policy=first)
