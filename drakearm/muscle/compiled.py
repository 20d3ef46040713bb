"""The decorators of all compiled functions: Numba, with a cache that notices when any of drakearm's sources changed.

`compiled` is for functions that Python calls, `inner` for those that only compiled functions call, and `inlined` for
those that are called in loops over lanes (see `drakearm.model.muscle_lanes`).
"""

import functools
import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite.binding
import numba
from numba.core import config, types
from numba.extending import intrinsic


def _cache_folder() -> Path:
    """The cache folder of the present state of the sources.

    Numba's own cache looks only at the file of a function, so it would keep functions whose callees in other files
    have changed.
    """
    user = config.CACHE_DIR  # type: ignore[attr-defined]
    base = user or Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "drakearm"
    state = hashlib.sha256()
    for file in sorted(Path(__file__).parents[1].rglob("*.py")):
        state.update(file.read_bytes())
    return Path(base) / state.hexdigest()[:16]


def _set_numba_options() -> None:
    """Changes two of Numba's options for the whole process: everything that it compiles from now on.

    Vectors of 512 bits where the processor has them: LLVM avoids them, but here they save a quarter of the time. And
    loops that are not unrolled: those over lanes are a few vectors long, and so they compile and run a tenth faster.
    Set the environment variable DRAKEARM_KEEP_NUMBA_OPTIONS to any text to leave both as they are. NUMBA_CPU_FEATURES,
    where it is set, decides about the vectors.
    """
    if os.environ.get("DRAKEARM_KEEP_NUMBA_OPTIONS"):
        return
    host = llvmlite.binding.get_host_cpu_features()
    if config.CPU_FEATURES is None and host.get("avx512f"):  # type: ignore[attr-defined]
        config.CPU_FEATURES = host.flatten() + ",-prefer-256-bit"  # type: ignore[attr-defined]
    llvmlite.binding.set_option("", "-force-vector-interleave=1")


_set_numba_options()
_FOLDER = str(_cache_folder())

# No "fastmath": the compiler may then not round in another order or fuse a product with a sum. So a function gives the
# same bits on every processor, and also where two functions hold separately compiled copies of it, of which a process
# uses the one that it happens to load first. Where fusing matters for speed, the code says `fma`.
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True}


def compiled(function: Callable[..., Any], **options: Any) -> Any:
    """Compiles a function with Numba: NumPy's rules for division by zero, cached between processes."""
    dispatcher = numba.njit(**_OPTIONS, **options)(function)
    before = config.CACHE_DIR  # type: ignore[attr-defined]
    config.CACHE_DIR = _FOLDER  # type: ignore[attr-defined]
    try:
        dispatcher.enable_caching()
    except RuntimeError:
        pass  # Numba finds no folder that it may write to: every process compiles for itself
    finally:
        config.CACHE_DIR = before  # type: ignore[attr-defined]
    return dispatcher


class _Inner:
    """A compiled function for other compiled functions, without a Python wrapper, which halves compile time.

    It can be called from Python too: each process compiles a wrapper when it is first needed.
    """

    def __init__(self, function: Callable[..., Any], **options: Any):
        self._dispatcher = compiled(function, no_cpython_wrapper=True, **options)
        self._numba_type_ = self._dispatcher._numba_type_  # makes Numba see the compiled function itself
        self.py_func = function
        functools.update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        return self._wrapper(*arguments)

    @functools.cached_property
    def _wrapper(self) -> Any:
        dispatcher = self._dispatcher
        return numba.njit(lambda *arguments: dispatcher(*arguments))


def inner(function: Callable[..., Any]) -> Any:
    """Like `compiled`, for functions that only compiled functions call: compiles in half the time."""
    return _Inner(function)


def inlined(function: Callable[..., Any]) -> Any:
    """Like `inner`, for functions called in a loop over lanes: inlined there, so that the loop can use vectors."""
    return _Inner(function, forceinline=True)


def _fma(typing_context, x, y, z):
    """x * y + z of doubles, rounded once: one instruction where the processor has it, and everywhere the same bits."""

    def generate(context, builder, signature, arguments):
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), generate


fma: Any = intrinsic(_fma)  # for compiled functions only
