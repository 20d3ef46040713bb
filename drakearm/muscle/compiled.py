"""The decorator of all compiled functions: Numba, with a cache that knows when any of drakearm's sources changed."""

import functools
import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite.binding
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


def _use_whole_vectors() -> None:
    """Lets Numba use vectors of 512 bits where the processor has them: LLVM avoids them, but here they save a quarter.

    Whoever sets NUMBA_CPU_FEATURES decides otherwise; code that Numba compiled before drakearm was imported stays.
    """
    features = config.CPU_FEATURES  # type: ignore[attr-defined]
    host = llvmlite.binding.get_host_cpu_features()
    if features is None and host.get("avx512f"):
        config.CPU_FEATURES = host.flatten() + ",-prefer-256-bit"  # type: ignore[attr-defined]


def _leave_loops_short() -> None:
    """Keeps LLVM from unrolling loops over lanes: those are a few vectors long, and so compile and run a tenth faster.

    Like the processor's features this holds for all that Numba compiles in this process from now on.
    """
    llvmlite.binding.set_option("", "-force-vector-interleave=1")


_use_whole_vectors()
_leave_loops_short()
_FOLDER = str(_cache_folder())


# Freedoms that leave NaN and infinity alone: to fuse a product with a sum, to multiply by the inverse of a divisor.
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "arcp"}, "no_cfunc_wrapper": True}


def compiled(function: Callable[..., Any], **options: Any) -> Any:
    """Compiles a function with Numba: NumPy's rules for division by zero, cached between processes."""
    dispatcher = numba.njit(**_OPTIONS, **options)(function)
    before = config.CACHE_DIR  # type: ignore[attr-defined]
    config.CACHE_DIR = _FOLDER  # type: ignore[attr-defined]
    try:
        dispatcher.enable_caching()
    except RuntimeError:
        pass  # Numba finds no folder that it may write: every process compiles for itself
    finally:
        config.CACHE_DIR = before  # type: ignore[attr-defined]
    return dispatcher


class _Inner:
    """A compiled function for other compiled functions, which spares the compiler the passage from Python.

    Called from Python it still works, by a passage that every process compiles when it is first needed.
    """

    def __init__(self, function: Callable[..., Any], **options: Any):
        self._dispatcher = compiled(function, no_cpython_wrapper=True, **options)
        self._numba_type_ = self._dispatcher._numba_type_  # makes Numba see the compiled function itself
        self.py_func = function
        functools.update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        return self._passage(*arguments)

    @functools.cached_property
    def _passage(self) -> Any:
        dispatcher = self._dispatcher
        return numba.njit(lambda *arguments: dispatcher(*arguments))


def inner(function: Callable[..., Any]) -> Any:
    """Like `compiled`, for what other compiled functions call: it compiles in half the time."""
    return _Inner(function)


def inlined(function: Callable[..., Any]) -> Any:
    """Like `inner`, for what stands in a loop over lanes: without a call the loop can use vector instructions."""
    return _Inner(function, forceinline=True)
