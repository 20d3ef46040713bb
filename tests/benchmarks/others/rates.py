"""What the measurements of speed share: their option, how a rate is measured, and the line of JSON that reports it."""

import argparse
import json
import statistics
import time
from collections.abc import Callable
from pathlib import Path

PARTS, PART = 5, 0.3  # s
QUICK_PARTS, QUICK_PART = 1, 0.06  # enough for the end of an episode


def is_quick(description: str | None) -> bool:
    """Reads the command line of a script with this description: whether it has the option `--quick`."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--quick", action="store_true", help="measures briefly: the same rows, but they mean nothing")
    return parser.parse_args().quick


def rate(call: Callable[[], object], quick: bool, clock: Callable[[], float] = time.process_time) -> float:
    """Calls per second, of CPU time by default: the median of some parts, after one part to warm up."""
    parts, seconds = (QUICK_PARTS, QUICK_PART) if quick else (PARTS, PART)
    rates = []
    for _ in range(parts + 1):
        calls, start = 0, clock()
        while (elapsed := clock() - start) < seconds:
            call()
            calls += 1
        rates.append(calls / elapsed)
    return statistics.median(rates[1:])


def report(
    what: str, *, arms: int, muscles: int, control_step: float, physics_step: float | None, steps: float
) -> None:
    """Prints a row as JSON.

    steps: control steps per second, of all arms together. physics_step: s; None where its length varies.
    """
    physics = steps * control_step / physics_step if physics_step else None
    row = {
        "what": what,
        "arms": arms,
        "muscles": muscles,
        "control_step": control_step,  # s
        "physics_step": physics_step,  # s
        "control_steps_per_second": steps,
        "physics_steps_per_second": physics,
        "memory": peak_memory(),  # MB
    }
    print(json.dumps(row), flush=True)


def peak_memory() -> float | None:
    """The most memory that this process has held so far, MB; None where the system does not tell."""
    status = Path("/proc/self/status")  # getrusage would count what the parent process held
    if not status.exists():
        return None
    (line,) = (line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024
