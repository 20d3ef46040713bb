"""The policy: its bounds, its repeatability and its file."""

import json

import numpy as np
import pytest
import torch
from safetensors.torch import load_file, save_file

from drakearm.errors import PolicyFileError, StorageError
from drakearm.learning.networks import Actor, Critic, policy_of
from drakearm.learning.policy import Policy

METADATA = {"scenario": "timing", "observation": "spindles", "seed": 3, "versions": {"torch": "2"}}


@pytest.fixture
def networks():
    generator = torch.Generator().manual_seed(0)
    actor = Actor(5, 3, (16, 16), initial_action=0.2, initial_std=0.5, generator=generator)
    with torch.no_grad():
        actor.mean[-1].weight.mul_(100)  # as after training: actions differ, and some reach the bounds
    return actor, Critic(5, (8,), generator=generator)


@pytest.fixture
def policy(networks):
    return policy_of(*networks, [0, 0, 0], [1, 1, 0.1], METADATA)


@pytest.fixture
def observations():
    return np.random.default_rng(1).normal(size=(7, 4, 5))


def test_first_actions_are_near_the_initial_action_with_the_initial_std():
    actor = Actor(28, 14, initial_action=0.15, initial_std=0.3)
    means = actor(torch.randn(1000, 28, generator=torch.Generator().manual_seed(0)))
    np.testing.assert_allclose(means.detach(), 0.15, atol=0.1)
    np.testing.assert_allclose(actor.log_std.exp().detach(), 0.3, rtol=1e-6)


def test_log_prob_and_entropy_are_those_of_the_gaussian(networks, observations):
    actor, _ = networks
    inputs = torch.tensor(observations, dtype=torch.float32)
    actions = torch.full((7, 4, 3), 0.7)
    gaussian = torch.distributions.Normal(actor(inputs), actor.log_std.exp())
    torch.testing.assert_close(actor.log_prob(inputs, actions), gaussian.log_prob(actions).sum(-1))
    torch.testing.assert_close(actor.entropy(), gaussian.entropy()[0, 0].sum())


def test_networks_do_not_touch_the_global_generator():
    before = torch.get_rng_state()
    Actor(5, 3), Critic(5)
    assert torch.equal(before, torch.get_rng_state())


def test_a_policy_computes_what_its_networks_do(networks, observations):
    actor, critic = networks
    policy = policy_of(actor, critic, [-np.inf] * 3, [np.inf] * 3, {})
    with torch.no_grad():
        inputs = torch.tensor(observations, dtype=torch.float32)
        np.testing.assert_allclose(policy.act(observations), actor(inputs), rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(policy.value(observations), critic(inputs), rtol=1e-5, atol=1e-6)


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
    np.testing.assert_array_equal(loaded.value(observations), policy.value(observations))
    assert loaded.metadata == METADATA
    assert (loaded.n_observations, loaded.n_actions) == (5, 3)
    np.testing.assert_array_equal(loaded.high, policy.high)
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_equal_policies_have_equal_files(policy, tmp_path):
    files = [tmp_path / f"{number}.safetensors" for number in range(5)]
    for file in files:
        policy.save(file)
    assert len({file.read_bytes() for file in files}) == 1
    assert set(load_file(files[0])) == set(policy.weights)


def test_infinite_bounds_survive_the_file(policy, tmp_path):
    policy.low[:], policy.high[:] = -np.inf, np.inf
    policy.save(tmp_path / "policy")
    np.testing.assert_array_equal(Policy.load(tmp_path / "policy").high, np.inf)


def test_metadata_that_json_cannot_hold_is_refused_at_once(policy):
    with pytest.raises(TypeError, match="JSON serializable"):
        Policy(policy.weights, policy.low, policy.high, {"seed": np.int64(1)})


def test_a_policy_from_layers_computes_what_they_do(networks, observations, tmp_path):
    linear = [module for module in networks[0].mean if hasattr(module, "weight")]
    layers = [(module.weight.detach().numpy(), module.bias.detach().numpy()) for module in linear]
    policy = Policy.from_layers(layers, std=0.5, metadata=METADATA)
    with torch.no_grad():
        expected = networks[0](torch.tensor(observations, dtype=torch.float32)).clamp(0.0, 1.0)
    np.testing.assert_allclose(policy.act(observations), expected, atol=1e-6)
    assert not policy.value(observations).any()
    policy.save(tmp_path / "policy.safetensors")
    loaded = Policy.load(tmp_path / "policy.safetensors")
    np.testing.assert_array_equal(loaded.act(observations), policy.act(observations))


@pytest.mark.parametrize("shapes", [[], [((4, 5), (3,))], [((4, 5), (4,)), ((3, 5), (3,))], [((5,), (5,))]])
def test_layers_that_do_not_fit_each_other_are_refused(shapes):
    with pytest.raises(PolicyFileError, match=r"expected \(n, n_in\)"):
        Policy.from_layers([(np.zeros(weight), np.zeros(bias)) for weight, bias in shapes])


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


def write_policy(policy, path, changes, weights=None):
    """Writes a policy with other fields or weights. A field that is None is left out."""
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
    header = {key: json.dumps(value) for key, value in (fields | changes).items() if value is not None}
    save_file({**load_file(path), **(weights or {})}, path, header)


def refusal(path) -> str:
    with pytest.raises(PolicyFileError) as error:
        Policy.load(path)
    message = str(error.value)
    assert str(path) in message and len(message) <= 300 and message.isprintable()
    return message


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"version": 99}, "version 99"),
        ({"version": True}, "version true"),
        ({"version": None}, "version None"),
        ({"actor_layers": [16, 17]}, "does not fit its weights"),
        ({"actor_layers": [16, 16, 1]}, "does not fit its weights"),
        ({"low": 0}, "does not fit its weights: low: found 0, expected a list"),
        ({"critic_layers": "wide"}, "does not fit its weights"),
        ({"actor_layers": [True, 16]}, "actor_layers.0: found True, expected a number"),
        ({"actor_layers": [[16], 16]}, "actor_layers.0: found [16], expected a whole number"),
        ({"actor_layers": [0]}, "actor_layers.0: found 0, expected a number greater than 0"),
        ({"actor_layers": [10**9, 10**9]}, "expected a number less than or equal to 1024"),
        ({"critic_layers": [1] * 1000}, "critic_layers: found [1, 1, 1"),
        ({"n_observations": 10**12}, "n_observations: found 1000000000000"),
        ({"n_observations": 10**6}, "the header does not fit its weights: found 480 numbers, expected"),
        ({"n_observations": -5}, "n_observations: found -5"),
        ({"low": [0, 0, float("nan")]}, "found NaN, expected a finite number"),
        ({"high": [1, 1]}, "found 3 lower and 2 upper bounds"),
        ({"low": [2, 0, 0]}, "found the bounds 2 and 1, expected the lower one first"),
        ({"low": ["0", 0, 0]}, "low.0: found '0', expected a number"),
        ({"metadata": [1]}, "metadata: found [1], expected fields with values"),
        ({"metadata": None}, "metadata: is missing, but required"),
        ({"metadata": {"seed": float("inf")}}, "found Infinity, expected a finite number"),
        ({"other": 1}, "other: there is no such field"),
    ],
)
def test_load_refuses_a_header_that_does_not_fit(policy, tmp_path, change, sentence):
    path = tmp_path / "policy.safetensors"
    write_policy(policy, path, change)
    assert sentence in refusal(path)


@pytest.mark.parametrize(
    ("weights", "sentence"),
    [
        (
            {"actor.log_std": torch.full((3,), torch.nan)},
            "actor.log_std: found a number that is too large or not finite",
        ),
        ({"actor.log_std": torch.full((3,), 90.0)}, "actor.log_std: found a number that is too large"),
        ({"actor.mean.0.weight": torch.full((16, 5), torch.inf)}, "actor.mean.0.weight: found a number that is too"),
        ({"critic.value.0.bias": torch.zeros(8, dtype=torch.float64)}, "found numbers of float64, expected"),
        ({"actor.mean.0.weight": torch.zeros(5, 16)}, "found the shape (5, 16), expected (16, 5)"),
        ({"other": torch.zeros(3)}, "found 483 numbers, expected 480"),
        ({"other": torch.zeros(0)}, "other: found a tensor that the policy does not have"),
    ],
)
def test_load_refuses_unsuitable_weights(policy, tmp_path, weights, sentence):
    path = tmp_path / "policy.safetensors"
    write_policy(policy, path, {}, weights)
    assert sentence in refusal(path)


def test_load_refuses_a_renamed_tensor(policy, tmp_path):
    path = tmp_path / "policy.safetensors"
    policy.save(path)
    data = path.read_bytes()
    path.write_bytes(data.replace(b"actor.log_std", b"actor.log_xyz"))
    assert "actor.log_std: is missing" in refusal(path)


@pytest.mark.parametrize("length", [0, 1, 10**7, 2**63, 2**64 - 1])
def test_load_refuses_a_header_of_another_length(policy, tmp_path, length):
    path = tmp_path / "policy.safetensors"
    policy.save(path)
    path.write_bytes(length.to_bytes(8, "little") + path.read_bytes()[8:])
    assert "damaged or not a policy file" in refusal(path)


def test_load_refuses_a_deep_header(policy, tmp_path):
    path = tmp_path / "policy.safetensors"
    policy.save(path)
    weights = load_file(path)
    save_file(weights, path, {"format": '"drakearm-policy"', "version": "1", "metadata": "[" * 10_000})
    assert "at most 50 lists and mappings inside each other" in refusal(path)


def test_a_policy_for_another_task_is_refused(task, policy):
    def bounded(low, high):
        return policy_of(Actor(task.observation.size, 14, (4,)), Critic(task.observation.size, (4,)), low, high, {})

    bounded(np.zeros(14), np.ones(14)).check(task)
    with pytest.raises(PolicyFileError, match="observations of length 5, but the task needs 58"):
        policy.check(task)
    with pytest.raises(PolicyFileError, match="from -1 to 1: expected excitations, which are from 0 to 1"):
        bounded(np.full(14, -1.0), np.ones(14)).check(task)
    with pytest.raises(PolicyFileError, match="actions are from 0 to inf"):
        bounded(np.zeros(14), np.full(14, np.inf)).check(task)
    other = policy_of(Actor(task.observation.size, 3, (4,)), Critic(task.observation.size), [0] * 3, [1] * 3, {})
    with pytest.raises(PolicyFileError, match="actions of length 3, but the task needs 14"):
        other.check(task)


def test_a_failed_save_keeps_the_earlier_policy(policy, tmp_path):
    path = tmp_path / "policy.safetensors"
    policy.save(path)
    before = path.read_bytes()
    with pytest.raises(StorageError, match="cannot be written"):
        policy.save(path / "below")
    assert path.read_bytes() == before
