"""The policy file: what its header holds, and how it is read and checked.

It is a safetensors file. The values of its header are JSON. No number is trusted: an unsuitable one is an error here,
not in the first control step.
"""

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, TypeAdapter, ValidationError, field_validator, model_validator
from safetensors import safe_open

from drakearm.errors import PolicyFileError, shown
from drakearm.files import parse_json
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Number, Whole
from drakearm.files.problems import first_problem

FORMAT = "drakearm-policy"
FORMAT_VERSION = 1
MODULE_FORMAT = "drakearm-module-policy"  # of a policy with networks of a user's own
_LARGEST_FILE, _LARGEST_HEADER = 500_000_000, 1_000_000  # bytes
_LARGEST_WEIGHT = 1e6  # larger ones overflow in float32 after a few layers
_LARGEST_LOG_STD = 50.0  # of the actions: larger ones overflow in float32

Layers = Annotated[tuple[Annotated[Whole, Field(gt=0, le=1024)], ...], Field(max_length=20)]  # widths of hidden layers
_Bounds = Annotated[tuple[Number, ...], Field(min_length=1, max_length=1000)]


@checked_dataclass()
class PolicyHeader:
    """Everything in a policy file but the weights. low and high, the bounds of the actions, may be infinite."""

    n_observations: Annotated[Whole, Field(gt=0, le=1_000_000)]
    actor_layers: Layers
    critic_layers: Layers
    low: _Bounds
    high: _Bounds
    metadata: dict[str, Any]

    @field_validator("low", "high")
    @classmethod
    def _are_numbers(cls, bounds: tuple[float, ...]) -> tuple[float, ...]:
        if any(math.isnan(bound) for bound in bounds):
            raise ValueError("expected bounds that are not NaN")
        return bounds

    @model_validator(mode="after")
    def _fit_each_other(self) -> "PolicyHeader":
        if len(self.low) != len(self.high):
            raise ValueError(f"found {len(self.low)} lower and {len(self.high)} upper bounds, expected as many of both")
        for low, high in zip(self.low, self.high, strict=True):
            if low > high:
                raise ValueError(f"found the bounds {low:g} and {high:g}, expected the lower one first")
        return self

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """The shapes of all weights: of the linear layers, of the standard deviations, and of the PReLUs' slopes."""
        shapes: dict[str, tuple[int, ...]] = {"actor.log_std": (len(self.low),)}
        for network, layers, outputs in (
            ("actor.mean", self.actor_layers, len(self.low)),
            ("critic.value", self.critic_layers, 1),
        ):
            for number, (before, after) in enumerate(pairwise((self.n_observations, *layers, outputs))):
                shapes[f"{network}.{2 * number}.weight"] = (after, before)
                shapes[f"{network}.{2 * number}.bias"] = (after,)
        slopes: dict[str, tuple[int, ...]] = {
            f"critic.value.{2 * number + 1}.weight": (1,) for number in range(len(self.critic_layers))
        }
        return shapes | slopes

    @property
    def n_weights(self) -> int:
        """How many numbers the weights have."""
        return sum(math.prod(shape) for shape in self.shapes.values())


def read_policy(file: Path) -> tuple[PolicyHeader, dict[str, NDArray[Any]]]:
    """Header and weights. Raises PolicyFileError if the file is no policy or has an invalid header."""
    texts, weights = _read(file)
    if json.dumps(MODULE_FORMAT) in texts.get("drakearm", ""):
        raise PolicyFileError(
            f"{shown(file)} is a safetensors file, but not a drakearm policy that the commands can read: it is a "
            "ModulePolicy, which `ModulePolicy.load(file, networks)` reads in a program."
        )
    if texts.pop("format", None) != json.dumps(FORMAT):
        raise PolicyFileError(f"{shown(file)} is a safetensors file, but not a drakearm policy.")
    version = texts.pop("version", None)
    if version != json.dumps(FORMAT_VERSION):
        raise PolicyFileError(
            f"{shown(file)} has version {str(version)[:40]} of the policy format, but this drakearm reads version "
            f"{FORMAT_VERSION}."
        )
    header = {
        key: parse_json(text, file, PolicyFileError, infinity=key in ("low", "high")) for key, text in texts.items()
    }
    try:
        return TypeAdapter(PolicyHeader).validate_python(header), weights
    except ValidationError as error:
        problem = first_problem(error, header, PolicyHeader)
        raise PolicyFileError(
            f"{shown(file)}: the header is damaged or does not fit its weights: {problem}."
        ) from error


def _read(file: Path) -> tuple[dict[str, str], dict[str, NDArray[Any]]]:
    """The header's texts and the tensors of a safetensors file."""
    what = "expected a safetensors file that `Policy.save` wrote"
    try:
        if not file.is_file():
            raise PolicyFileError(f"There is no policy file {shown(file)}.")
        if file.stat().st_size > _LARGEST_FILE:
            raise PolicyFileError(f"{shown(file)} is larger than {_LARGEST_FILE // 1_000_000} MB: {what}.")
        with file.open("rb") as stream:
            length = int.from_bytes(stream.read(8), "little")
        if length > _LARGEST_HEADER:
            raise PolicyFileError(f"{shown(file)} is damaged or not a policy file: its header is too long; {what}.")
        with safe_open(file, framework="np") as tensors:
            return tensors.metadata() or {}, {name: tensors.get_tensor(name) for name in tensors.keys()}
    except PolicyFileError:
        raise
    except Exception as error:  # for damaged bytes, safetensors and NumPy raise errors of several types
        raise PolicyFileError(f"{shown(file)} is damaged or not a policy file: {what}.") from error


def tensor_problem(name: str, found: NDArray[Any] | None, expected: tuple[int, ...] | None) -> str | None:
    """What is wrong with a tensor of a file, of which a shape is expected; None if nothing is."""
    largest = _LARGEST_LOG_STD if name == "actor.log_std" else _LARGEST_WEIGHT
    if found is None:
        return "is missing: the header does not fit its weights"
    if expected is None:
        return "found a tensor that the policy does not have: the header does not fit its weights"
    if found.dtype != np.float32:
        return f"found numbers of {found.dtype}, expected float32"
    if found.shape != expected:
        return f"found the shape {shown(found.shape)}, expected {expected}: the header does not fit its weights"
    if not bool(np.all(np.abs(found) <= largest)):  # this is false for NaN too
        return f"found a number that is too large or not finite, expected at most {largest:g}"
    return None


def sorted_header(data: bytes) -> bytes:
    """The content of a safetensors file with its header in alphabetical order.

    safetensors writes the texts of the header in a random order. So equal policies would have different files.
    """
    size = int.from_bytes(data[:8], "little")
    text = json.dumps(json.loads(data[8 : 8 + size]), sort_keys=True, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 8)  # the weights begin at a multiple of 8 bytes
    return len(text).to_bytes(8, "little") + text + data[8 + size :]
