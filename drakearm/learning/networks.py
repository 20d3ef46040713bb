"""The networks that learn: the actor maps an observation to an action, the critic to its value."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import torch
from numpy.typing import ArrayLike
from torch import Tensor, nn

from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.policy import Policy


def _mlp(
    sizes: Sequence[int],
    activation: Callable[[], nn.Module],
    last_gain: float,
    generator: torch.Generator | None,
) -> nn.Sequential:
    """Linear layers of the given `sizes` (first: input, last: output), `activation` between them.

    Weights are orthogonal (Saxe, McClelland, Ganguli 2014) and drawn from `generator` only.
    """
    generator = generator or torch.Generator()
    modules: list[nn.Module] = []
    for inputs, outputs in pairwise(sizes):
        # skip_init: the usual constructor would draw from torch's global generator.
        linear = nn.utils.skip_init(nn.Linear, inputs, outputs)
        nn.init.orthogonal_(linear.weight, gain=2**0.5, generator=generator)
        nn.init.zeros_(linear.bias)
        modules += [linear, activation()]
    modules.pop()
    with torch.no_grad():
        linear.weight *= last_gain / 2**0.5
    return nn.Sequential(*modules)


class Actor(nn.Module):
    """A Gaussian over actions. Its mean is a tanh MLP of the observation; its standard deviation does not depend on it.

    mean: a network of your own instead of the MLP: (n, n_obs) to (n, n_act). layers, initial_action and generator are
    those of the MLP.

    initial_action: the mean before training, in the action's unit. It is nearly the same for all observations, because
    the weights of the last layer start small. initial_std: the standard deviation before training, in the same unit.
    learns_std: whether training changes the standard deviation by its gradient. generator: draws the initial weights;
    without one, they are the same every time.
    """

    def __init__(
        self,
        n_observations: int,
        n_actions: int,
        layers: Sequence[int] = (64,) * 5,
        *,
        initial_action: float = 0.15,
        initial_std: float = 0.3,
        learns_std: bool = True,
        generator: torch.Generator | None = None,
        mean: nn.Module | None = None,
    ) -> None:
        super().__init__()
        self.learns_std = learns_std
        if mean is None:
            mean = _mlp((n_observations, *layers, n_actions), nn.Tanh, 0.01, generator)
            nn.init.constant_(mean[-1].bias, initial_action)  # type: ignore[arg-type]
        self.mean = mean
        self.log_std = nn.Parameter(torch.full((n_actions,), initial_std).log())

    def set_std(self, std: float) -> None:
        """Sets the standard deviation of all actions."""
        with torch.no_grad():
            self.log_std.fill_(math.log(std))

    def forward(self, observations: Tensor) -> Tensor:
        """The mean action, (..., n_act), of `observations`, (..., n_obs)."""
        result: Tensor = self.mean(observations)
        return result

    def log_prob(self, observations: Tensor, actions: Tensor) -> Tensor:
        """The log-density (...) of `actions` (..., n_act) that are not clipped to the bounds."""
        return self.log_density((actions - self(observations)) * torch.exp(-self.log_std))

    def log_density(self, z: Tensor) -> Tensor:
        """The log-density (...) of actions that lie `z`, (..., n_act), standard deviations from their means."""
        log_scale = self.log_std.sum() + 0.5 * math.log(2 * math.pi) * self.log_std.numel()
        return -0.5 * z.square().sum(-1) - log_scale

    def entropy(self) -> Tensor:
        """The entropy of the Gaussian in nats, the same for every observation."""
        return (self.log_std + 0.5 * math.log(2 * math.pi * math.e)).sum()


class Critic(nn.Module):
    """The value of an observation: the expected discounted sum of all later rewards. It is an MLP with PReLU.

    value: a network of your own instead of the MLP: (n, n_obs) to (n, 1).
    """

    def __init__(
        self,
        n_observations: int,
        layers: Sequence[int] = (64,) * 3,
        *,
        generator: torch.Generator | None = None,
        value: nn.Module | None = None,
    ) -> None:
        super().__init__()
        self.value = _mlp((n_observations, *layers, 1), nn.PReLU, 1.0, generator) if value is None else value

    def forward(self, observations: Tensor) -> Tensor:
        """The value (...) of `observations`, (..., n_obs)."""
        result: Tensor = self.value(observations).squeeze(-1)
        return result


def policy_of(
    actor: Actor,
    critic: Critic,
    low: ArrayLike,
    high: ArrayLike,
    metadata: dict[str, Any],
    scaling: InputScaling | None = None,
) -> Policy:
    """The policy with a copy of the present weights of two networks. It takes observations that are not scaled.

    low, high, metadata: see `Policy`. scaling: of the observations that the networks take; None: they are not scaled.
    """
    weights: dict[str, np.ndarray] = {}
    for name, network in (("actor", actor), ("critic", critic)):
        weights |= {f"{name}.{key}": tensor.numpy(force=True).copy() for key, tensor in network.state_dict().items()}
    if scaling:
        for first in ("actor.mean.0", "critic.value.0"):
            folded = scaling.folded(weights[f"{first}.weight"], weights[f"{first}.bias"])
            weights[f"{first}.weight"], weights[f"{first}.bias"] = folded
    return Policy(weights, low, high, metadata)
