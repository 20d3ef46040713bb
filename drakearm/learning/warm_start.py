"""Warm start: a training that begins with the weights of a saved policy, for example with another reward or task."""

import numpy as np
import torch
from gymnasium.vector import VectorEnv
from torch import Tensor, nn

from drakearm.errors import TrainingError
from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.module_policy import ModulePolicy
from drakearm.learning.networks import Actor, Critic
from drakearm.learning.policy import Policy


def warm_start(policy: Policy, actor: Actor, critic: Critic, envs: VectorEnv, steps: int, seed: int) -> InputScaling:
    """Gives two networks the weights of a policy. Returns the scaling of their inputs.

    With this scaling, the networks compute what the policy computes. A `ModulePolicy` has the scaling of its training.
    Another policy has none, because its weights contain it: then the policy acts for some steps, and the scaling is
    that of what it observes. Raises TrainingError if the policy has other networks, observations or actions.
    """
    expected = envs.single_observation_space.shape, envs.single_action_space.shape
    found = (policy.n_observations,), policy.low.shape
    if found != expected:
        raise TrainingError(
            f"The initial policy has observations and actions of the shapes {found[0]} and {found[1]}: "
            f"expected {expected[0]} and {expected[1]}, as the environments have them."
        )
    if isinstance(policy, ModulePolicy):
        scaling = policy.scaling
        weights = policy.state_dicts()
    else:
        scaling = _observed(policy, envs, steps, seed)
        weights = _unfolded(policy, scaling)
    for name, network, state in (("actor", actor, weights[0]), ("critic", critic, weights[1])):
        _load(name, network, state)
    return scaling


def _observed(policy: Policy, envs: VectorEnv, steps: int, seed: int) -> InputScaling:
    """The scaling that standardizes what a policy observes while it acts with its noise."""
    rng = np.random.default_rng(seed)
    observation, _ = envs.reset(seed=seed)
    observations = [observation]
    for _ in range(steps):
        observation, *_ = envs.step(policy.act(observation, rng))
        observations.append(observation)
    return InputScaling.of(np.concatenate(observations))


def _unfolded(policy: Policy, scaling: InputScaling) -> list[dict[str, Tensor]]:
    """The weights of the actor and the critic for scaled observations."""
    weights = dict(policy.weights)
    for first in ("actor.mean.0", "critic.value.0"):
        unfolded = scaling.unfolded(weights[f"{first}.weight"], weights[f"{first}.bias"])
        weights[f"{first}.weight"], weights[f"{first}.bias"] = unfolded
    return [
        {key.removeprefix(start): torch.tensor(array) for key, array in weights.items() if key.startswith(start)}
        for start in ("actor.", "critic.")
    ]


def _load(name: str, network: nn.Module, state: dict[str, Tensor]) -> None:
    own = {key: tuple(tensor.shape) for key, tensor in network.state_dict().items()}
    given = {key: tuple(tensor.shape) for key, tensor in state.items()}
    for key in dict.fromkeys((*own, *given)):
        if own.get(key) != given.get(key):
            raise TrainingError(
                f"The {name} of the initial policy has the weights {key} of shape {given.get(key)}: expected "
                f"{own.get(key)}, for the networks of this training."
            )
    network.load_state_dict(state)
