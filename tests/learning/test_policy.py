"""The policy: its bounds, its repeatability and its file."""

import json

import numpy as np
import pytest
import torch
from safetensors.torch import load_file, save_file

from drakearm.errors import PolicyFileError
from drakearm.learning.policy import Actor, Critic, Policy

METADATA = {"scenario": "timing", "observation": "spindles", "seed": 3, "versions": {"torch": "2"}}


@pytest.fixture
def policy():
    generator = torch.Generator().manual_seed(0)
    actor = Actor(5, 3, (16, 16), initial_action=0.2, initial_std=0.5, generator=generator)
    with torch.no_grad():
        actor.mean[-1].weight.mul_(100)  # as after training: actions differ, and some reach the bounds
    return Policy(actor, Critic(5, (8,), generator=generator), [0, 0, 0], [1, 1, 0.1], METADATA)


@pytest.fixture
def observations():
    return np.random.default_rng(1).normal(size=(7, 4, 5))


def test_first_actions_are_near_the_initial_action_with_the_initial_std():
    actor = Actor(28, 14, initial_action=0.15, initial_std=0.3)
    means = actor(torch.randn(1000, 28, generator=torch.Generator().manual_seed(0)))
    np.testing.assert_allclose(means.detach(), 0.15, atol=0.1)
    np.testing.assert_allclose(actor.log_std.exp().detach(), 0.3, rtol=1e-6)


def test_log_prob_and_entropy_are_those_of_the_gaussian(policy, observations):
    inputs = torch.tensor(observations, dtype=torch.float32)
    actions = torch.full((7, 4, 3), 0.7)
    gaussian = torch.distributions.Normal(policy.actor(inputs), policy.actor.log_std.exp())
    torch.testing.assert_close(policy.actor.log_prob(inputs, actions), gaussian.log_prob(actions).sum(-1))
    torch.testing.assert_close(policy.actor.entropy(), gaussian.entropy()[0, 0].sum())


def test_networks_do_not_touch_the_global_generator():
    before = torch.get_rng_state()
    Policy(Actor(5, 3), Critic(5), [0, 0, 0], [1, 1, 1], {})
    assert torch.equal(before, torch.get_rng_state())


def test_act_keeps_leading_axes_and_bounds(policy, observations):
    for rng in (None, np.random.default_rng(0)):
        actions = policy.act(observations, rng)
        assert actions.shape == (7, 4, 3)
        assert (actions >= policy.low).all() and (actions <= policy.high).all()
        assert (actions == policy.high).any() and (actions < policy.high).any()
    assert policy.act(observations[0, 0]).shape == (3,)


def test_act_depends_on_the_generator_alone(policy, observations):
    def noisy():
        return policy.act(observations, np.random.default_rng(5))

    np.testing.assert_array_equal(noisy(), noisy())
    np.testing.assert_array_equal(policy.act(observations), policy.act(observations))
    assert (noisy() != policy.act(observations)).any()


def test_samples_have_the_policys_mean_and_deviation(policy):
    policy.low[:], policy.high[:] = -np.inf, np.inf
    observation = np.ones(5)
    rng = np.random.default_rng(0)
    samples = policy.act(np.tile(observation, (20_000, 1)), rng)
    np.testing.assert_allclose(samples.mean(0), policy.act(observation), atol=0.02)
    np.testing.assert_allclose(samples.std(0), 0.5, atol=0.01)


@pytest.mark.parametrize("shape", [(4,), (2, 6), ()])
def test_refuses_observations_of_another_length(policy, shape):
    with pytest.raises(PolicyFileError, match="observations of length 5"):
        policy.act(np.zeros(shape))


def test_a_loaded_policy_acts_like_the_saved_one(policy, observations, tmp_path):
    path = tmp_path / "runs" / "policy.safetensors"
    policy.save(path)
    loaded = Policy.load(path)
    np.testing.assert_array_equal(loaded.act(observations), policy.act(observations))
    np.testing.assert_array_equal(
        loaded.act(observations, np.random.default_rng(2)),
        policy.act(observations, np.random.default_rng(2)),
    )
    inputs = torch.tensor(observations, dtype=torch.float32)
    assert torch.equal(loaded.critic(inputs), policy.critic(inputs))
    assert loaded.metadata == METADATA
    assert (loaded.n_observations, loaded.n_actions) == (5, 3)
    np.testing.assert_array_equal(loaded.high, policy.high)
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_infinite_bounds_survive_the_file(policy, tmp_path):
    policy.low[:], policy.high[:] = -np.inf, np.inf
    policy.save(tmp_path / "policy")
    np.testing.assert_array_equal(Policy.load(tmp_path / "policy").high, np.inf)


def test_metadata_that_json_cannot_hold_is_refused_at_once(policy):
    with pytest.raises(TypeError, match="JSON serializable"):
        Policy(policy.actor, policy.critic, policy.low, policy.high, {"seed": np.int64(1)})


def test_load_names_a_missing_file(tmp_path):
    with pytest.raises(PolicyFileError, match=r"no policy file .*absent"):
        Policy.load(tmp_path / "absent")


@pytest.mark.parametrize("content", [b"", b"hello", b"\x00" * 100])
def test_load_refuses_other_files(tmp_path, content):
    path = tmp_path / "policy.safetensors"
    path.write_bytes(content)
    with pytest.raises(PolicyFileError, match="damaged or not a policy file"):
        Policy.load(path)


def test_load_refuses_a_truncated_file(policy, tmp_path):
    path = tmp_path / "policy.safetensors"
    policy.save(path)
    path.write_bytes(path.read_bytes()[:-10])
    with pytest.raises(PolicyFileError, match="damaged"):
        Policy.load(path)


@pytest.mark.parametrize("header", [None, {"format": "pt"}, {"format": '"another"'}])
def test_load_refuses_foreign_safetensors(tmp_path, header):
    path = tmp_path / "policy.safetensors"
    save_file({"weight": torch.zeros(3)}, path, header)
    with pytest.raises(PolicyFileError, match="not a drakearm policy"):
        Policy.load(path)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"version": 99}, "version 99"),
        ({"actor_layers": [16, 17]}, "does not fit its weights"),
        ({"low": 0}, "does not fit its weights"),
        ({"critic_layers": "wide"}, "does not fit its weights"),
    ],
)
def test_load_refuses_a_header_that_does_not_fit(policy, tmp_path, change, sentence):
    path = tmp_path / "policy.safetensors"
    policy.save(path)
    fields = {
        "format": "drakearm-policy",
        "version": 1,
        "n_observations": 5,
        "actor_layers": [16, 16],
        "critic_layers": [8],
        "low": [0, 0, 0],
        "high": [1, 1, 1],
        "metadata": {},
    }
    header = {key: json.dumps(value) for key, value in (fields | change).items()}
    save_file(load_file(path), path, header)
    with pytest.raises(PolicyFileError, match=sentence):
        Policy.load(path)
