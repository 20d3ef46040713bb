"""Saves dataclasses of arrays as .npz files and loads them."""

from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from drakearm.errors import RunFolderError

T = TypeVar("T")


def save_arrays(instance: Any, file: Path) -> None:
    """Writes every field of a dataclass of arrays into a compressed .npz."""
    np.savez_compressed(file, **{f.name: getattr(instance, f.name) for f in fields(instance)})


def load_arrays(cls: type[T], file: Path) -> T:
    """Reads what `save_arrays` wrote. Raises RunFolderError if the file is missing, is damaged or lacks an array."""
    names = [f.name for f in fields(cls)]  # type: ignore[arg-type]
    try:
        with np.load(file) as arrays:
            return cls(**{name: arrays[name] for name in names})
    except (OSError, KeyError, ValueError) as error:
        raise RunFolderError(
            f"{file} is not a {cls.__name__.lower()}: expected an .npz with {', '.join(names)} ({error})."
        ) from error
