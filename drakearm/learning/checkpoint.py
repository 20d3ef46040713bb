"""Checkpoints: everything that a training needs to continue as if it had never stopped."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import safetensors.numpy
import torch
from safetensors import SafetensorError, safe_open

from drakearm.errors import TrainingError, shown
from drakearm.files import replacement

FORMAT = "drakearm-checkpoint"
FORMAT_VERSION = 2


@dataclass
class Checkpoint:
    """The state of a training after a batch.

    inputs: what must be the same when it continues, such as settings and seed. progress: numbers such as the batch and
    the learning rate. arrays: weights, optimizers, generators and environments, under names such as "actor/weights".
    """

    inputs: dict[str, Any]
    progress: dict[str, float]
    arrays: dict[str, np.ndarray] = field(default_factory=dict)

    def add(self, parts: Mapping[str, Any]) -> None:
        """Adds the `state` of each part, a dictionary of arrays, under the name of the part."""
        for part, thing in parts.items():
            self.arrays |= {f"{part}/{name}": array for name, array in thing.state.items()}

    def restore(self, parts: Mapping[str, Any]) -> None:
        """Sets the `state` of each part to what was added under its name."""
        for part, thing in parts.items():
            start = f"{part}/"
            thing.state = {name.removeprefix(start): a for name, a in self.arrays.items() if name.startswith(start)}

    def save(self, file: Path) -> None:
        """Writes the checkpoint as a safetensors file, whole or not at all."""
        header = {"format": FORMAT, "version": FORMAT_VERSION} | asdict(self)
        del header["arrays"]
        text = {"drakearm": json.dumps(header)}
        contiguous = {name: np.ascontiguousarray(array) for name, array in self.arrays.items()}
        with replacement(file) as partial:
            partial.write_bytes(safetensors.numpy.save(contiguous, text))

    @classmethod
    def load(cls, file: Path) -> "Checkpoint":
        """Reads what `save` wrote. Raises TrainingError for any other file."""
        try:
            with safe_open(file, framework="np") as opened:
                header = json.loads((opened.metadata() or {}).get("drakearm", "{}"))
                arrays = {name: opened.get_tensor(name) for name in opened.keys()}
        except (SafetensorError, OSError, ValueError, RecursionError) as error:
            raise TrainingError(f"{shown(file)} is damaged or no checkpoint: {error}.") from error
        if (header.get("format"), header.get("version")) != (FORMAT, FORMAT_VERSION):
            raise TrainingError(f"{shown(file)} is no checkpoint of this version of drakearm.")
        return cls(header["inputs"], header["progress"], arrays)


class TorchGenerator:
    """A generator of PyTorch as a part of a checkpoint."""

    def __init__(self, generator: torch.Generator):
        self._generator = generator

    @property
    def state(self) -> dict[str, np.ndarray]:
        return {"state": self._generator.get_state().numpy()}

    @state.setter
    def state(self, arrays: dict[str, np.ndarray]) -> None:
        self._generator.set_state(torch.from_numpy(arrays["state"].copy()))


class Environments:
    """A vector environment as a part of a checkpoint.

    The vector environment itself or each of its environments must have a property `state`, a dictionary of arrays that
    can be set. Raises TrainingError if it has none.
    """

    def __init__(self, envs: Any):  # a VectorEnv, but Gymnasium declares get_attr and set_attr in derived classes only
        self._envs = envs
        self._together = hasattr(type(envs), "state")
        if not self._together:
            try:
                self._envs.get_attr("state")
            except Exception as error:  # Gymnasium's own ones, and those that a process of an environment reports
                raise TrainingError(
                    "The training cannot be continued later: expected environments with a property `state`."
                ) from error

    @property
    def state(self) -> dict[str, np.ndarray]:
        if self._together:
            return self._envs.state
        states = self._envs.get_attr("state")
        return {f"{i}/{name}": array for i, state in enumerate(states) for name, array in state.items()}

    @state.setter
    def state(self, arrays: dict[str, np.ndarray]) -> None:
        if self._together:
            self._envs.state = arrays
            return
        states: list[dict[str, np.ndarray]] = [{} for _ in range(self._envs.num_envs)]
        for name, array in arrays.items():
            index, own_name = name.split("/", 1)
            states[int(index)][own_name] = array
        self._envs.set_attr("state", states)
