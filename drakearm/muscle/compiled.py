"""The decorator of all compiled functions: Numba, with a cache that knows when any of drakearm's sources changed."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba.core import config


def _cache_folder() -> Path:
    """One folder for every state of the sources.

    Numba's own cache looks at the file of a function only, so it keeps functions whose callees in other files changed.
    """
    user = config.CACHE_DIR  # type: ignore[attr-defined]
    base = user or Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "drakearm"
    state = hashlib.sha256()
    for file in sorted(Path(__file__).parents[1].rglob("*.py")):
        state.update(file.read_bytes())
    return Path(base) / state.hexdigest()[:16]


_FOLDER = str(_cache_folder())


def compiled(function: Callable[..., Any]) -> Any:
    """Compiles a function with Numba: NumPy's rules for division by zero, cached between processes."""
    dispatcher = numba.njit(error_model="numpy")(function)
    before = config.CACHE_DIR  # type: ignore[attr-defined]
    config.CACHE_DIR = _FOLDER  # type: ignore[attr-defined]
    try:
        dispatcher.enable_caching()
    except RuntimeError:
        pass  # Numba finds no folder that it may write: every process compiles for itself
    finally:
        config.CACHE_DIR = before  # type: ignore[attr-defined]
    return dispatcher
