"""Scaling of inputs: observations are standardized, and a folded network computes the same from unscaled ones."""

import numpy as np
import pytest
import torch

from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.networks import Actor


@pytest.fixture
def observations():
    return torch.from_numpy(np.random.default_rng(0).normal([1.0, 0.0, -3.0], [0.3, 1.0, 20.0], (500, 3))).float()


def test_the_scaled_observations_have_mean_0_and_deviation_1(observations):
    scaled = InputScaling.of(observations.numpy())(observations.numpy())
    np.testing.assert_allclose(scaled.mean(axis=0), 0.0, atol=1e-5)
    np.testing.assert_allclose(scaled.std(axis=0), [0.94, 0.98, 1.0], atol=0.02)


def test_an_observation_that_never_varies_stays_finite():
    scaled = InputScaling.of(np.ones((10, 2)))(np.array([1.0, 1.1], np.float32))
    np.testing.assert_allclose(scaled, [0.0, 5.0], rtol=1e-5)


def test_a_folded_network_computes_the_same_from_unscaled_observations(observations):
    actor, scaling = Actor(3, 4, (16, 16)), InputScaling.of(observations.numpy())
    expected = actor(torch.from_numpy(scaling(observations.numpy())))
    first = actor.mean[0]
    weight, bias = scaling.folded(first.weight.detach().numpy(), first.bias.detach().numpy())
    with torch.no_grad():
        first.weight.copy_(torch.from_numpy(weight))
        first.bias.copy_(torch.from_numpy(bias))
    torch.testing.assert_close(actor(observations), expected, rtol=1e-4, atol=1e-5)


def test_no_scaling_changes_nothing(observations):
    scaling = InputScaling.none(3)
    np.testing.assert_array_equal(scaling(observations.numpy()), observations.numpy())


def test_unfolding_is_the_opposite_of_folding(observations):
    scaling, rng = InputScaling.of(observations.numpy()), np.random.default_rng(1)
    weight, bias = rng.normal(size=(4, 3)).astype(np.float32), rng.normal(size=4).astype(np.float32)
    for ours, expected in zip(scaling.unfolded(*scaling.folded(weight, bias)), (weight, bias), strict=True):
        np.testing.assert_allclose(ours, expected, rtol=1e-5, atol=1e-5)
