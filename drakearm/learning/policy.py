"""The networks that map an observation to an action and to its value, and the policy file."""

import json
import math
import os
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import safetensors.torch
import torch
from numpy.typing import ArrayLike, NDArray
from safetensors import SafetensorError, safe_open
from torch import Tensor, nn

from drakearm.errors import PolicyFileError

FORMAT = "drakearm-policy"
FORMAT_VERSION = 1


def _mlp(
    sizes: Sequence[int],
    activation: Callable[[], nn.Module],
    last_gain: float,
    generator: torch.Generator,
) -> nn.Sequential:
    """Linear layers of the given `sizes` (first: input, last: output), `activation` between them.

    Weights are orthogonal (Saxe, McClelland, Ganguli 2014) and drawn from `generator` only.
    """
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
    ) -> None:
        super().__init__()
        self.learns_std = learns_std
        self.layers = tuple(layers)
        sizes = (n_observations, *layers, n_actions)
        self.mean = _mlp(sizes, nn.Tanh, 0.01, generator or torch.Generator())
        nn.init.constant_(self.mean[-1].bias, initial_action)  # type: ignore[arg-type]
        self.log_std = nn.Parameter(torch.full((n_actions,), initial_std).log())

    def set_std(self, std: float) -> None:
        """Sets the standard deviation of all actions."""
        with torch.no_grad():
            self.log_std.fill_(math.log(std))

    def forward(self, observations: Tensor) -> Tensor:
        """The mean action, (..., n_act), of `observations`, (..., n_obs)."""
        return self.mean(observations)

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
    """The value of an observation: the expected discounted sum of all later rewards."""

    def __init__(
        self,
        n_observations: int,
        layers: Sequence[int] = (64,) * 3,
        *,
        generator: torch.Generator | None = None,
    ) -> None:
        super().__init__()
        self.layers = tuple(layers)
        sizes = (n_observations, *layers, 1)
        self.value = _mlp(sizes, nn.PReLU, 1.0, generator or torch.Generator())

    def forward(self, observations: Tensor) -> Tensor:
        """The value (...) of `observations`, (..., n_obs)."""
        return self.value(observations).squeeze(-1)


class Policy(nn.Module):
    """A trained actor and critic, with action bounds and metadata.

    low, high: (n_act,), the bounds. metadata: any JSON object, for example with the names of scenario and observation,
    seeds and versions. Raises TypeError for metadata that is not JSON.
    """

    def __init__(
        self,
        actor: Actor,
        critic: Critic,
        low: ArrayLike,
        high: ArrayLike,
        metadata: dict[str, Any],
    ) -> None:
        super().__init__()
        self.actor = actor
        self.critic = critic
        self.low: NDArray[np.float64] = np.array(low, dtype=np.float64)
        self.high: NDArray[np.float64] = np.array(high, dtype=np.float64)
        # Converted to JSON and back: metadata that a file cannot hold fails here, before a long training.
        self.metadata: dict[str, Any] = json.loads(json.dumps(metadata))

    @property
    def n_observations(self) -> int:
        return self.actor.mean[0].in_features  # type: ignore[return-value]

    @property
    def n_actions(self) -> int:
        return len(self.low)

    def act(self, observation: ArrayLike, rng: np.random.Generator | None = None) -> NDArray[np.float64]:
        """The action (..., n_act), within the bounds, for `observation`, (..., n_obs).

        Without `rng` it is the mean of the actor's Gaussian. With `rng` it is a sample, which draws from `rng` only.
        Raises PolicyFileError if the length of the observation is not that of the policy.
        """
        # A copy, in memory that torch aligns: the last digits of a matrix product depend on the alignment.
        inputs = torch.tensor(np.asarray(observation), dtype=torch.float32)
        if inputs.shape[-1:] != (self.n_observations,):
            raise PolicyFileError(
                f"The policy was trained on observations of length {self.n_observations}, "
                f"but was given one of shape {tuple(inputs.shape)}."
            )
        with torch.no_grad():
            action = self.actor(inputs).numpy().astype(np.float64)
            std = self.actor.log_std.exp().numpy()
        if rng is not None:
            action += std * rng.standard_normal(action.shape)
        return np.clip(action, self.low, self.high)

    def save(self, path: Path | str) -> None:
        """Writes the policy as a safetensors file. Its header holds everything but the weights, as JSON.

        The file is replaced only when the new one is complete: a process that is killed before leaves the old file.
        """
        header = {
            "format": FORMAT,
            "version": FORMAT_VERSION,
            "n_observations": self.n_observations,
            "actor_layers": self.actor.layers,
            "critic_layers": self.critic.layers,
            "low": self.low.tolist(),
            "high": self.high.tolist(),
            "metadata": self.metadata,
        }
        data = safetensors.torch.save(self.state_dict(), {key: json.dumps(value) for key, value in header.items()})
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        partial = path.with_name(path.name + ".partial")
        partial.write_bytes(data)
        os.replace(partial, path)

    @classmethod
    def load(cls, path: Path | str) -> "Policy":
        """Reads what `save` wrote. Raises PolicyFileError for any other file."""
        path = Path(path)
        if not path.is_file():
            raise PolicyFileError(f"There is no policy file {path}.")
        try:
            with safe_open(path, framework="pt") as file:
                header = file.metadata() or {}
                weights = {name: file.get_tensor(name) for name in file.keys()}
        except (SafetensorError, OSError) as error:
            raise PolicyFileError(f"{path} is damaged or not a policy file: expected safetensors ({error}).") from error
        try:
            fields = {key: json.loads(value) for key, value in header.items()}
        except ValueError:
            fields = {}
        if fields.get("format") != FORMAT:
            raise PolicyFileError(f"{path} is a safetensors file, but not a drakearm policy.")
        if fields.get("version") != FORMAT_VERSION:
            raise PolicyFileError(
                f"{path} has version {fields.get('version')} of the policy format, "
                f"but this drakearm reads version {FORMAT_VERSION}."
            )
        try:
            n_observations, low = fields["n_observations"], fields["low"]
            policy = cls(
                Actor(n_observations, len(low), fields["actor_layers"]),
                Critic(n_observations, fields["critic_layers"]),
                low,
                fields["high"],
                fields["metadata"],
            )
            policy.load_state_dict(weights)
        except (KeyError, TypeError, ValueError, RuntimeError) as error:
            raise PolicyFileError(
                f"The policy file {path} is damaged: its header does not fit its weights ({error})."
            ) from error
        return policy
