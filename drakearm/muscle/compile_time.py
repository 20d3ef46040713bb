"""The time that work takes without compilation, which only the first call of a function in a process needs."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from numba.core.event import TimingListener, install_listener


@contextmanager
def without_compilation() -> Iterator[Callable[[], float]]:
    """Measures the time of a block. What it gives returns the time since the block began, s, without compilation.

    Compilation is all that Numba does before it can call a function: it compiles it, or loads it from the compile
    cache.
    """
    with install_listener("numba:compiler_lock", TimingListener()) as compilation:
        began = time.perf_counter()

        def elapsed() -> float:
            compiled = compilation.duration if compilation.done else 0.0
            return time.perf_counter() - began - compiled

        yield elapsed
