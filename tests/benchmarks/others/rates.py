"""What all measurements of speed share: how a rate is measured, and the line of JSON that tells it."""

import json
import statistics
import time
from collections.abc import Callable
from pathlib import Path


def rate(call: Callable[[], object], clock: Callable[[], float] = time.process_time, parts: int = 5) -> float:
    """Calls a second, of CPU time by default: the median of parts of 0.3 s each, after one part to warm up."""
    rates = []
    for _ in range(parts + 1):
        calls, start = 0, clock()
        while (elapsed := clock() - start) < 0.3:
            call()
            calls += 1
        rates.append(calls / elapsed)
    return statistics.median(rates[1:])


def report(
    what: str, *, arms: int, muscles: int, control_step: float, physics_step: float | None, steps: float
) -> None:
    """Prints a row as JSON. steps: control steps a second, of all arms together; physics_step: None where it varies."""
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
    """The most memory that this process has held, MB; None where the system does not tell."""
    status = Path("/proc/self/status")  # getrusage would count what the parent process held
    if not status.exists():
        return None
    (line,) = (line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024
