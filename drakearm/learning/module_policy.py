"""A policy whose actor and critic are any modules of PyTorch."""

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import safetensors.torch
import torch
from numpy.typing import ArrayLike, NDArray
from safetensors import SafetensorError, safe_open
from torch import nn

from drakearm.errors import PolicyFileError, TrainingError, shown
from drakearm.files import replacement
from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.networks import Actor, Critic
from drakearm.learning.policy import Policy
from drakearm.learning.policy_file import MODULE_FORMAT as FORMAT

FORMAT_VERSION = 1

# From the numbers of observations and actions to the actor's mean, (n, n_obs) to (n, n_act), and the critic's value,
# (n, n_obs) to (n, 1).
Networks = Callable[[int, int], tuple[nn.Module, nn.Module]]


def own_networks(
    networks: Networks, n_observations: int, n_actions: int, seed: int, std: float, learns_std: bool
) -> tuple[Actor, Critic]:
    """Actor and critic from a user's modules, whose initial weights the seed determines.

    Raises TrainingError if the modules do not map observations to actions and to values, if they remember earlier
    observations, or if they compute something else in training mode than in evaluation mode: PPO compares the actions
    of a batch with those of the same network later.
    """
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        mean, value = networks(n_observations, n_actions)
        for name, network, expected in (("actor", mean, (2, n_actions)), ("critic", value, (2, 1))):
            _check_network(name, network, n_observations, expected)
    actor = Actor(n_observations, n_actions, initial_std=std, learns_std=learns_std, mean=mean)
    return actor, Critic(n_observations, value=value)


@torch.no_grad()
def _check_network(name: str, network: nn.Module, n_observations: int, expected: tuple[int, int]) -> None:
    observations = torch.linspace(-1.0, 1.0, 2 * n_observations).reshape(2, n_observations)
    try:
        outputs = network(observations)
        found = tuple(outputs.shape)
        evaluated = copy.deepcopy(network).eval()
        first, second = evaluated(observations), evaluated(observations)
    except Exception as error:  # whatever a user's code raises
        raise TrainingError(
            f"The network of the {name} cannot take 2 observations of length {n_observations}: {error}"
        ) from error
    if found != expected:
        raise TrainingError(
            f"The network of the {name} makes outputs of shape {found} from 2 observations: expected {expected}."
        )
    if not _same(first, second):
        raise TrainingError(
            f"The network of the {name} computes different outputs from the same observations: expected modules that "
            "have no memory between steps and draw no random numbers. Senses can hold what was earlier."
        )
    if not _same(outputs, first):
        raise TrainingError(
            f"The network of the {name} computes something else in training mode than in evaluation mode, as dropout "
            "and batch normalization do: expected modules without them, for example with layer normalization."
        )


def _same(first: torch.Tensor, second: torch.Tensor) -> bool:
    return torch.allclose(first, second, rtol=1e-4, atol=1e-6, equal_nan=True)


class ModulePolicy(Policy):
    """A policy with a copy of two networks, which it evaluates with PyTorch. It acts like any other `Policy`.

    Its file holds the weights, but not what the networks compute. So `ModulePolicy.load` needs the function that makes
    them, and the commands of drakearm cannot read the file.
    """

    def __init__(
        self,
        actor: Actor,
        critic: Critic,
        n_observations: int,
        low: ArrayLike,
        high: ArrayLike,
        metadata: dict[str, Any],
        scaling: InputScaling,
    ) -> None:
        self._modules = copy.deepcopy(actor).cpu().eval(), copy.deepcopy(critic).cpu().eval()
        self._size, self._scaling = n_observations, scaling
        self.low, self.high = np.array(low, dtype=np.float64), np.array(high, dtype=np.float64)
        self.metadata = json.loads(json.dumps(metadata))

    @property
    def n_observations(self) -> int:
        return self._size

    @property
    def scaling(self) -> InputScaling:
        """Of the observations, before the networks get them."""
        return self._scaling

    def state_dicts(self) -> list[dict[str, torch.Tensor]]:
        """The weights of the actor and of the critic, as PyTorch has them."""
        return [network.state_dict() for network in self._modules]

    @torch.no_grad()
    def act(self, observation: ArrayLike, rng: np.random.Generator | None = None) -> NDArray[np.float64]:
        """See `Policy.act`."""
        actor = self._modules[0]
        action = self._evaluate(actor, observation)
        if rng is not None:
            action += actor.log_std.exp().numpy() * rng.standard_normal(action.shape)
        return np.clip(action, self.low, self.high)

    @torch.no_grad()
    def value(self, observation: ArrayLike) -> NDArray[np.float64]:
        """See `Policy.value`."""
        return self._evaluate(self._modules[1], observation)

    def _evaluate(self, network: nn.Module, observation: ArrayLike) -> NDArray[np.float64]:
        inputs = self._inputs(observation)
        rows = torch.tensor(self._scaling(inputs.reshape(-1, self._size)))
        found: NDArray[np.float64] = network(rows).numpy().astype(np.float64)
        return found.reshape(*inputs.shape[:-1], *found.shape[1:])

    def save(self, path: Path | str) -> None:
        """Writes the weights as a safetensors file. Raises StorageError if the file cannot be written."""
        tensors = {"input.mean": torch.tensor(self._scaling.mean), "input.scale": torch.tensor(self._scaling.scale)}
        for name, network in zip(("actor", "critic"), self._modules, strict=True):
            tensors |= {f"{name}.{key}": value.clone() for key, value in network.state_dict().items()}
        header = {
            "format": FORMAT,
            "version": FORMAT_VERSION,
            "n_observations": self._size,
            "low": self.low.tolist(),
            "high": self.high.tolist(),
            "metadata": self.metadata,
        }
        with replacement(Path(path)) as partial:
            partial.write_bytes(safetensors.torch.save(tensors, {"drakearm": json.dumps(header)}))

    @classmethod
    def load(cls, path: Path | str, networks: Networks | None = None) -> "ModulePolicy":
        """Reads what `save` wrote. networks: those that were trained. Raises PolicyFileError for any other file."""
        path = Path(path)
        if networks is None:
            raise PolicyFileError(f"{shown(path)}: expected also the function that makes the networks of the policy.")
        try:
            with safe_open(path, framework="pt") as opened:
                header = json.loads((opened.metadata() or {}).get("drakearm", "{}"))
                tensors = {name: opened.get_tensor(name) for name in opened.keys()}
        except (SafetensorError, OSError, ValueError, RecursionError) as error:
            raise PolicyFileError(f"{shown(path)} is damaged or no file of a policy: {error}.") from error
        if (header.get("format"), header.get("version")) != (FORMAT, FORMAT_VERSION):
            raise PolicyFileError(f"{shown(path)} is no policy with networks of your own, of version {FORMAT_VERSION}.")
        size, n_actions = header["n_observations"], len(header["low"])
        actor, critic = own_networks(networks, size, n_actions, 0, 1.0, False)
        scaling = InputScaling(tensors.pop("input.mean").numpy(), tensors.pop("input.scale").numpy())
        try:
            for name, network in (("actor", actor), ("critic", critic)):
                start = f"{name}."
                own = {key.removeprefix(start): value for key, value in tensors.items() if key.startswith(start)}
                network.load_state_dict(own)
        except RuntimeError as error:
            raise PolicyFileError(f"{shown(path)} holds the weights of other networks: {error}") from error
        return cls(actor, critic, size, header["low"], header["high"], header["metadata"], scaling)
