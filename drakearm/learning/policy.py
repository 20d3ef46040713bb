"""The networks that map an observation to an action and to its value, and the policy file."""

import json
import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import safetensors.torch
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor, nn

from drakearm.errors import PolicyFileError, shown
from drakearm.files import replacement
from drakearm.learning.policy_file import FORMAT, FORMAT_VERSION, read_policy, sorted_header, tensor_problem
from drakearm.task import TrackingTask


def _mlp(
    sizes: Sequence[int],
    activation: Callable[[], nn.Module],
    last_gain: float,
    generator: torch.Generator | None,
    initialize: bool,
) -> nn.Sequential:
    """Linear layers of the given `sizes` (first: input, last: output), `activation` between them.

    Weights are orthogonal (Saxe, McClelland, Ganguli 2014) and drawn from `generator` only. initialize: False leaves
    them undefined, for weights that are loaded afterwards, because to draw them takes time.
    """
    generator = generator or torch.Generator()
    modules: list[nn.Module] = []
    for inputs, outputs in pairwise(sizes):
        # skip_init: the usual constructor would draw from torch's global generator.
        linear = nn.utils.skip_init(nn.Linear, inputs, outputs)
        if initialize:
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
    without one, they are the same every time. initialize: see `_mlp`.
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
        initialize: bool = True,
    ) -> None:
        super().__init__()
        self.learns_std = learns_std
        self.layers = tuple(layers)
        sizes = (n_observations, *layers, n_actions)
        self.mean = _mlp(sizes, nn.Tanh, 0.01, generator, initialize)
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
        initialize: bool = True,
    ) -> None:
        super().__init__()
        self.layers = tuple(layers)
        sizes = (n_observations, *layers, 1)
        self.value = _mlp(sizes, nn.PReLU, 1.0, generator, initialize)

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

    def check(self, task: TrackingTask) -> None:
        """Raises PolicyFileError unless the policy maps the task's observations to excitations of its muscles."""
        for what, found, expected in (
            ("observations of length", self.n_observations, task.observation.size),
            ("actions of length", self.n_actions, len(task.arm.muscles)),
        ):
            if found != expected:
                raise PolicyFileError(f"The policy has {what} {found}, but the task needs {expected}.")
        if self.low.min() < 0.0 or self.high.max() > 1.0:
            raise PolicyFileError(
                f"The policy's actions are from {self.low.min():g} to {self.high.max():g}: "
                f"expected excitations, which are from 0 to 1."
            )

    def save(self, path: Path | str) -> None:
        """Writes the policy as a safetensors file. Its header holds everything but the weights, as JSON.

        Raises StorageError if the file cannot be written; an earlier file is then still there.
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
        with replacement(Path(path)) as partial:
            partial.write_bytes(sorted_header(data))

    @classmethod
    def load(cls, path: Path | str) -> "Policy":
        """Reads what `save` wrote. Raises PolicyFileError for any other file."""
        path = Path(path)
        header, weights = read_policy(path)
        # Building networks takes memory and time. So their size is compared with the file's first.
        numbers = sum(tensor.numel() for tensor in weights.values())
        if numbers != header.n_weights:
            raise PolicyFileError(
                f"{shown(path)}: the header does not fit its weights: found {numbers} numbers, expected "
                f"{header.n_weights} for layers of these widths."
            )
        policy = cls(
            Actor(header.n_observations, len(header.low), header.actor_layers, initialize=False),
            Critic(header.n_observations, header.critic_layers, initialize=False),
            header.low,
            header.high,
            header.metadata,
        )
        expected = policy.state_dict()
        for name in sorted(expected.keys() | weights.keys()):
            problem = tensor_problem(name, weights.get(name), expected.get(name))
            if problem:
                raise PolicyFileError(f"{shown(path)}: {name[:60]}: {problem}.")
        policy.load_state_dict(weights)
        return policy
