"""The policy: maps observations to actions, and is kept in a file. It is evaluated with NumPy alone."""

import json
import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import safetensors.numpy
from numpy.typing import ArrayLike, NDArray

from drakearm.errors import PolicyFileError, shown
from drakearm.files import replacement
from drakearm.learning.policy_file import FORMAT, FORMAT_VERSION, read_policy, sorted_header, tensor_problem
from drakearm.task import TrackingTask


class Policy:
    """A trained actor and critic, with action bounds and metadata.

    weights: of an `Actor` and a `Critic`, float32, under the names of PyTorch's modules: "actor.mean.0.weight"
    (n, n_obs), "actor.mean.0.bias" (n,) and so on, "actor.log_std" (n_act,), and the same for "critic.value".
    low, high: (n_act,), the bounds. metadata: any JSON object, for example with the names of scenario and observation,
    seeds and versions. Raises TypeError for metadata that is not JSON.
    """

    def __init__(
        self, weights: Mapping[str, NDArray[np.float32]], low: ArrayLike, high: ArrayLike, metadata: dict[str, Any]
    ) -> None:
        self.weights = dict(weights)
        self.low: NDArray[np.float64] = np.array(low, dtype=np.float64)
        self.high: NDArray[np.float64] = np.array(high, dtype=np.float64)
        # Converted to JSON and back: metadata that a file cannot hold fails here, before a long training.
        self.metadata: dict[str, Any] = json.loads(json.dumps(metadata))
        self._actor, self._critic = self._layers("actor.mean"), self._layers("critic.value")
        self._std = np.exp(self.weights["actor.log_std"])

    def _layers(self, network: str) -> list[tuple[NDArray[np.float32], NDArray[np.float32]]]:
        """Weight and bias of each linear layer of a network. Between two of them is an activation, which counts too."""
        layers: list[tuple[NDArray[np.float32], NDArray[np.float32]]] = []
        while f"{network}.{2 * len(layers)}.weight" in self.weights:
            name = f"{network}.{2 * len(layers)}"
            layers.append((self.weights[f"{name}.weight"], self.weights[f"{name}.bias"]))
        return layers

    @property
    def n_observations(self) -> int:
        return self._actor[0][0].shape[1]

    @property
    def n_actions(self) -> int:
        return len(self.low)

    def act(self, observation: ArrayLike, rng: np.random.Generator | None = None) -> NDArray[np.float64]:
        """The action (..., n_act), within the bounds, for `observation`, (..., n_obs).

        Without `rng` it is the mean of the actor's Gaussian. With `rng` it is a sample, which draws from `rng` only.
        Raises PolicyFileError if the length of the observation is not that of the policy.
        """
        x = self._inputs(observation)
        for number, (weight, bias) in enumerate(self._actor):
            if number:
                x = np.tanh(x)
            x = x @ weight.T + bias
        action = x.astype(np.float64)
        if rng is not None:
            action += self._std * rng.standard_normal(action.shape)
        return np.clip(action, self.low, self.high)

    def value(self, observation: ArrayLike) -> NDArray[np.float64]:
        """What the critic expects (...) after `observation`, (..., n_obs): the discounted sum of all later rewards."""
        x = self._inputs(observation)
        for number, (weight, bias) in enumerate(self._critic):
            if number:
                x = np.where(x > 0.0, x, self.weights[f"critic.value.{2 * number - 1}.weight"] * x)
            x = x @ weight.T + bias
        return x[..., 0].astype(np.float64)

    def _inputs(self, observation: ArrayLike) -> NDArray[np.float32]:
        inputs = np.array(observation, dtype=np.float32, order="C")
        if inputs.shape[-1:] != (self.n_observations,):
            raise PolicyFileError(
                f"The policy was trained on observations of length {self.n_observations}, "
                f"but was given one of shape {inputs.shape}."
            )
        return inputs

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
            "actor_layers": [len(bias) for _, bias in self._actor[:-1]],
            "critic_layers": [len(bias) for _, bias in self._critic[:-1]],
            "low": self.low.tolist(),
            "high": self.high.tolist(),
            "metadata": self.metadata,
        }
        data = safetensors.numpy.save(self.weights, {key: json.dumps(value) for key, value in header.items()})
        with replacement(Path(path)) as partial:
            partial.write_bytes(sorted_header(data))

    @classmethod
    def from_layers(
        cls,
        layers: Sequence[tuple[ArrayLike, ArrayLike]],
        *,
        std: float = 0.001,
        metadata: dict[str, Any] | None = None,
    ) -> "Policy":
        """The policy of a network that was trained elsewhere: linear layers with tanh between them.

        layers: weight (n, n_in) and bias (n,) of each layer, from observations to excitations, which are clipped to
        0 and 1. std: standard deviation of the noise, where noise is asked for. The value of the policy is 0, because
        it has learned no critic. Raises PolicyFileError if the layers do not fit each other.
        """
        arrays = [(np.array(weight, np.float32), np.array(bias, np.float32)) for weight, bias in layers]
        fit = all(weight.ndim == 2 and weight.shape[:1] == bias.shape for weight, bias in arrays)
        follow = all(after[0].shape[1:] == before[1].shape for before, after in pairwise(arrays))
        if not (arrays and fit and follow):
            shapes = ", ".join(f"{weight.shape} and {bias.shape}" for weight, bias in arrays) or "none"
            raise PolicyFileError(
                f"The layers have weights and biases of the shapes {shapes}: expected (n, n_in) and (n,), and n_in "
                "outputs of the layer before."
            )
        n = len(arrays[-1][1])
        weights = {"actor.log_std": np.full(n, math.log(std), np.float32)}
        for number, (weight, bias) in enumerate(arrays):
            weights |= {f"actor.mean.{2 * number}.weight": weight, f"actor.mean.{2 * number}.bias": bias}
        weights["critic.value.0.weight"] = np.zeros((1, arrays[0][0].shape[1]), np.float32)
        weights["critic.value.0.bias"] = np.zeros(1, np.float32)
        return cls(weights, np.zeros(n), np.ones(n), metadata or {})

    @classmethod
    def load(cls, path: Path | str) -> "Policy":
        """Reads what `save` wrote. Raises PolicyFileError for any other file."""
        path = Path(path)
        header, weights = read_policy(path)
        expected = header.shapes
        numbers = sum(tensor.size for tensor in weights.values())
        if numbers != header.n_weights:
            raise PolicyFileError(
                f"{shown(path)}: the header does not fit its weights: found {numbers} numbers, expected "
                f"{header.n_weights} for layers of these widths."
            )
        for name in sorted(expected.keys() | weights.keys()):
            problem = tensor_problem(name, weights.get(name), expected.get(name))
            if problem:
                raise PolicyFileError(f"{shown(path)}: {name[:60]}: {problem}.")
        return cls(weights, header.low, header.high, header.metadata)
