"""The decorators of all compiled functions: Numba, with the compile cache of drakearm.

There are three decorators:

- `compiled`: for functions that Python code calls.
- `inner`: for functions that only compiled functions call.
- `inlined`: for functions that are called in a loop over lanes.

**Lanes.** A lane is one of several arms that are simulated side by side. The last index of an array (..., lanes) is the
lane, so the same number of all these arms, such as the length of one fiber, lies next to each other in memory. The
compiler turns a loop over the lanes into vector instructions, each of which computes several lanes. It can do so only
if the functions called in the loop are inlined there, and if they select values instead of branching.

**Two versions.** Some functions exist for one arm (`muscle_step`, `fiber_step`, `evaluate_paths`) and for lanes
(`step_muscle_lanes`, `fiber_steps`, `evaluate_path_lanes`). Those for one arm are simple and keep nothing between two
calls: Drake's Systems use them. Those for lanes are faster for many arms, as learning needs, and keep working memory
between calls. Tests compare the two versions with each other.

**Arithmetic.** A function must give the same bits on every processor, so the compiler may not change how results are
rounded (see `_OPTIONS`). What it could do for speed if it were allowed to is therefore written in the code:

- `fma(x, y, z)` is x * y + z in one instruction.
- A product with a constant's reciprocal replaces a division by the constant, because a division takes longer. Where the
  constant is a number of the muscle, a loop over lanes computes the reciprocal once.
"""

import functools
import os
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import llvmlite.binding
import numba
from numba.core import config, types
from numba.extending import intrinsic

from drakearm.muscle.compile_cache import CompileCache, cache_folder


def _set_numba_options() -> None:
    """Changes two options of Numba for the whole process, that is, for everything that it compiles from now on.

    - Vectors of 512 bits, where the processor has them. LLVM avoids them, but here they save a quarter of the time.
    - No unrolling of loops. The loops over lanes are only a few vectors long: without unrolling they compile and run a
      tenth faster.

    To keep Numba's own options, set the environment variable DRAKEARM_KEEP_NUMBA_OPTIONS to any text. If
    NUMBA_CPU_FEATURES is set, it decides about the vectors.
    """
    if os.environ.get("DRAKEARM_KEEP_NUMBA_OPTIONS"):
        return
    host = llvmlite.binding.get_host_cpu_features()
    if config.CPU_FEATURES is None and host.get("avx512f"):  # type: ignore[attr-defined]
        config.CPU_FEATURES = host.flatten() + ",-prefer-256-bit"  # type: ignore[attr-defined]
    llvmlite.binding.set_option("", "-force-vector-interleave=1")


_set_numba_options()
_FOLDER = cache_folder()

# Numba's option `fastmath` is off. With it the compiler may reorder sums and fuse a product with a sum, which changes
# the last bits. Without it a function gives the same bits on every processor. It also gives the same bits in every
# process: two compiled functions may each contain a compiled copy of a third one, and a process uses whichever copy it
# loads first.
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True}


def compiled(function: Callable[..., Any], **options: Any) -> Any:
    """Compiles a function with Numba, for calls from Python. The result is kept on disk for later processes.

    A function that is not defined in a file, such as one in a notebook, is not kept. A division by zero gives inf or
    NaN, as in NumPy.
    """
    dispatcher = numba.njit(**_OPTIONS, **options)(function)
    with suppress(OSError):  # it is not from a file
        dispatcher._cache = CompileCache(dispatcher, _FOLDER)
    return dispatcher


class _Inner:
    """A compiled function for other compiled functions, without a Python wrapper, which halves compile time.

    Python can call it too: each process compiles a wrapper at the first such call.
    """

    def __init__(self, function: Callable[..., Any], **options: Any):
        self._dispatcher = compiled(function, no_cpython_wrapper=True, **options)
        self._numba_type_ = self._dispatcher._numba_type_  # compiled callers use the dispatcher directly
        self.py_func = function
        functools.update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        return self._wrapper(*arguments)

    @functools.cached_property
    def _wrapper(self) -> Any:
        dispatcher = self._dispatcher
        return numba.njit(lambda *arguments: dispatcher(*arguments))


def inner(function: Callable[..., Any]) -> Any:
    """Like `compiled`, for functions that only compiled functions call: they compile in half the time."""
    return _Inner(function)


def inlined(function: Callable[..., Any]) -> Any:
    """Like `inner`, for functions called in a loop over lanes: inlined, so the loop can use vector instructions."""
    return _Inner(function, forceinline=True)


def _fma(typing_context, x, y, z):
    """x * y + z of doubles, rounded only once: one instruction on most processors, and the same bits on all."""

    def generate(context, builder, signature, arguments):
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), generate


fma: Any = intrinsic(_fma)  # for compiled functions only
