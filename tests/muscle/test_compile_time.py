"""The time of work without compilation."""

import time

import numba

from drakearm.muscle.compile_time import without_compilation


def both(work):
    """The time of some work without compilation, and its time in all, which begins later and ends earlier."""
    with without_compilation() as elapsed:
        began = time.perf_counter()
        work()
        in_all = time.perf_counter() - began
        return elapsed(), in_all


def test_compilation_does_not_count_but_all_else_does():
    @numba.njit
    def double(x):
        return 2 * x

    without, in_all = both(lambda: double(1.0))
    assert 0.0 <= without < in_all
    without, in_all = both(lambda: double(1.0))  # it is compiled already
    assert without >= in_all
