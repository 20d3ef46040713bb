"""Reads and uses thousands of malformed files, and prints what came of them.

`python tests/attacks/fuzz.py` tries 10 000 files. Each must be accepted, with finite results, or refused with one
sentence. `--quick` tries fewer, `--case scenario:17` repeats one in this process. The files do not depend on the number
of jobs. The exit code is 1 if something else happened.
"""

import argparse
import itertools
import multiprocessing
import os
import resource
import shutil
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from drakearm.errors import LONGEST_MESSAGE, DrakearmError
from tests.attacks.seeds import make_seeds
from tests.attacks.targets import Target

SOURCE = "tests.attacks.targets"  # the module whose function `targets` gives the types of files
LONGEST = 20.0  # s that a case may take
_STARTING = 300.0  # s that a worker may take to start, if everything must be compiled first
_MEMORY = 6 * 2**30  # bytes of a worker, beyond which an allocation fails
ACCEPTED, REFUSED = "accepted", "refused"


@dataclass
class Row:
    """What came of the files of one type."""

    tried: int = 0
    accepted: int = 0
    refused: int = 0
    others: list[str] = field(default_factory=list)  # each with its case
    slowest: tuple[float, str] = (0.0, "")  # s, and the case


def outcome(target: Target, seeds: Path, folder: Path, seed: int) -> str:
    """ACCEPTED, REFUSED, or what else happened."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a NaN counts where it reaches a result
            result = target.attack(seeds, folder, seed)
    except DrakearmError as error:
        message = str(error)
        if len(message) > LONGEST_MESSAGE or "\n" in message or not message.isprintable():
            return f"no sentence of {LONGEST_MESSAGE} characters: {message!r}"
        return REFUSED
    except BaseException as error:  # SystemExit and KeyboardInterrupt are no answers either
        place = traceback.extract_tb(error.__traceback__)[-1]
        return f"{type(error).__name__}: {str(error)[:200]!r} in {Path(place.filename).name}:{place.lineno}"
    return ACCEPTED if is_finite(result) else "a result that is not finite"


def is_finite(result: Any) -> bool:
    """Whether all numbers in a result are finite."""
    if isinstance(result, Mapping):
        return all(is_finite(value) for value in result.values())
    if isinstance(result, list | tuple):
        return all(is_finite(value) for value in result)
    if isinstance(result, int | float | np.ndarray | np.number):
        return not isinstance(result, float | np.ndarray | np.number) or bool(np.isfinite(result).all())
    return True


def _work(source: str, seeds: Path, scratch: Path, connection: Connection) -> None:
    """Answers cases until it is killed. scratch: an empty folder. What Drake prints to the terminal is not shown."""
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY, _MEMORY))
    targets: dict[str, Target] = import_module(source).targets()
    for target in targets.values():  # loads what is compiled
        shutil.copytree(seeds, scratch / target.name)
        target.use(scratch / target.name)
    connection.send(None)
    while True:
        name, seed = connection.recv()
        connection.send(outcome(targets[name], seeds, scratch / "case", seed))
        shutil.rmtree(scratch / "case", ignore_errors=True)


class Worker:
    """A process that answers cases. It can die or hang without harm to the others."""

    def __init__(self, source: str, seeds: Path, longest: float):
        self.case: tuple[str, int] | None = None
        self._longest = longest
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self._scratch = tempfile.TemporaryDirectory(prefix="fuzz-")  # of this process, because the worker is killed
        self._process = context.Process(
            target=_work, args=(source, seeds, Path(self._scratch.name), theirs), daemon=True
        )
        self._process.start()
        theirs.close()
        self._since = time.monotonic()

    def give(self, case: tuple[str, int]) -> None:
        self.case, self._since = case, time.monotonic()
        self.connection.send(case)

    def answer(self) -> tuple[str, float] | None:
        """What came of the case, and after how many seconds; None as long as that is open."""
        seconds = time.monotonic() - self._since
        limit = self._longest if self.case else _STARTING
        if self.connection.poll():
            try:
                return self.connection.recv() or "ready", seconds
            except (EOFError, ConnectionError):
                self._process.join()
                return f"the process ended with exit code {self._process.exitcode}", seconds
        return (f"no end after {seconds:.0f} s", seconds) if seconds > limit else None

    def stop(self) -> None:
        self._process.kill()
        self._process.join()
        self.connection.close()
        self._scratch.cleanup()


def run(
    cases: Iterable[tuple[str, int]],
    *,
    jobs: int,
    source: str = SOURCE,
    longest: float = LONGEST,
    seeds: Path | None = None,
) -> dict[str, Row]:
    """Tries the cases, each the name of a type of file and a number, and counts what came of them."""
    with tempfile.TemporaryDirectory(prefix="fuzz-seeds-") as scratch:
        if seeds is None:
            seeds = Path(scratch) / "seeds"
            make_seeds(seeds)
        return _share_out(iter(cases), jobs, source, longest, seeds)


def _share_out(cases: Iterable[tuple[str, int]], jobs: int, source: str, longest: float, seeds: Path) -> dict[str, Row]:
    rows: dict[str, Row] = {}
    workers = [Worker(source, seeds, longest) for _ in range(jobs)]
    tried, shown = 0, time.monotonic()
    try:
        while workers:
            wait([worker.connection for worker in workers], timeout=0.2)
            for i, worker in reversed(list(enumerate(workers))):
                answer = worker.answer()
                if answer is None:
                    continue
                if worker.case is None and answer[0] != "ready":
                    raise RuntimeError(f"A worker did not start: {answer[0]}.")
                if worker.case:
                    tried += 1
                    _count(rows, worker.case, *answer)
                if answer[0].startswith(("the process ended", "no end")):
                    worker.stop()
                    workers[i] = worker = Worker(source, seeds, longest)
                    continue
                case = next(cases, None)
                if case is None:
                    workers.pop(i).stop()
                else:
                    worker.give(case)
            if sys.stderr.isatty() and time.monotonic() - shown > 1.0:
                shown = time.monotonic()
                print(f"\r{tried} files", end="", file=sys.stderr, flush=True)
    finally:
        for worker in workers:
            worker.stop()
    return rows


def _count(rows: dict[str, Row], case: tuple[str, int], what: str, seconds: float) -> None:
    name, seed = case
    row = rows.setdefault(name, Row())
    row.tried += 1
    row.slowest = max(row.slowest, (seconds, f"{name}:{seed}"))
    if what == ACCEPTED:
        row.accepted += 1
    elif what == REFUSED:
        row.refused += 1
    else:
        row.others.append(f"{name}:{seed}: {what}")


def choose_cases(number: int, seed: int) -> list[tuple[str, int]]:
    """This many cases, of all types of files in turn, with numbers from `seed` times a million on."""
    queues = [
        [(target.name, seed * 1_000_000 + k) for k in range(max(1, round(number * target.share)))]
        for target in import_module(SOURCE).targets().values()
    ]
    return [case for row in itertools.zip_longest(*queues) for case in row if case]


def print_table(rows: dict[str, Row]) -> None:
    print(f"\n{'file':12}{'tried':>7}{'accepted':>10}{'refused':>9}{'other':>7}{'slowest':>10}")
    for name, row in rows.items():
        print(
            f"{name:12}{row.tried:7}{row.accepted:10}{row.refused:9}{len(row.others):7}{row.slowest[0]:8.1f} s"
            f"  {row.slowest[1]}"
        )
    others = [other for row in rows.values() for other in row.others]
    print("\n" + "\n".join(others[:40]) if others else "\nEvery file was accepted or refused in one sentence.")


def repeat(case: str) -> int:
    """Tries one case in this process and shows what happens. The files stay where they can be looked at."""
    name, seed = case.split(":")
    target = import_module(SOURCE).targets()[name]
    folder = Path(tempfile.mkdtemp(prefix="fuzz-"))
    make_seeds(folder / "seeds")
    print(f"The mutated file is in {folder / 'case'}.")
    began = time.monotonic()
    try:
        result = target.attack(folder / "seeds", folder / "case", int(seed))
    except DrakearmError as error:
        print(f"Refused after {time.monotonic() - began:.1f} s: {error}")
        return 0
    print(f"Accepted after {time.monotonic() - began:.1f} s: {result}")
    return 0 if is_finite(result) else 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--quick", action="store_true", help="300 cases")
    parser.add_argument("--case", help="repeat one, for example scenario:17")
    options = parser.parse_args()
    if options.case:
        return repeat(options.case)
    began = time.monotonic()
    rows = run(choose_cases(300 if options.quick else options.cases, options.seed), jobs=options.jobs)
    print_table(rows)
    print(f"{sum(row.tried for row in rows.values())} files in {time.monotonic() - began:.0f} s")
    return 1 if any(row.others for row in rows.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
