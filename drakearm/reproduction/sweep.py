"""A sweep: many trials in parallel, each in its own folder."""

import logging
import os
import signal
import threading
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import lru_cache
from typing import Protocol

import torch
from joblib import Parallel, delayed
from joblib.externals.loky.process_executor import TerminatedWorkerError

from drakearm.errors import DrakearmError, SweepError
from drakearm.reproduction.backends import workers
from drakearm.reproduction.board import Board, Post
from drakearm.reproduction.choices import Backend
from drakearm.reproduction.trial import Trial
from drakearm.reproduction.trial_folder import TrialFolder

_LOOK = 0.5  # s, between two looks at the board
_LEAST, _SHORTEST = 0.005, 5.0  # share of the work that must be done, and time in s, before the rest is estimated


class Watch(Protocol):
    """Is told again and again how far a sweep is.

    running: what the trials do that run now. seconds_left: None while it cannot be estimated.
    """

    def __call__(self, done: int, total: int, running: Mapping[str, Post], seconds_left: float | None) -> None: ...


def run_trials(
    folders: Sequence[TrialFolder],
    board: Board,
    *,
    jobs: int | None = None,
    backend: Backend | None = None,
    overwrite: bool = False,
    prepare: Callable[[], None] | None = None,
    watch: Watch | None = None,
) -> dict[Trial, str]:
    """Completes trials, those with most work first. Returns why some of them failed.

    A DrakearmError in one trial does not stop the others. jobs, backend: see `workers`. prepare: is called in each
    worker before a trial, and must be picklable. Raises SweepError if the backend's package is missing, or if a worker
    is killed.
    """
    board.clear()  # a killed sweep may have left posts
    ordered = sorted(folders, key=lambda folder: -folder.work)
    failures: dict[Trial, str] = {}
    ended: set[int] = set()
    tasks = (
        delayed(_work)(number, folder, board, overwrite, prepare, os.getpid()) for number, folder in enumerate(ordered)
    )
    with workers(backend, jobs), _watching(ordered, ended, board, watch):
        results = Parallel(return_as="generator_unordered", batch_size=1, pre_dispatch="n_jobs")(tasks)
        try:
            for number, problem in results:
                ended.add(number)
                if problem is not None:
                    failures[ordered[number].trial] = problem
        except TerminatedWorkerError as error:
            raise SweepError(
                "A worker ended unexpectedly: the same command continues; "
                "if there was too little memory, with fewer --jobs."
            ) from error
        finally:
            results.close()
            board.clear()
    return failures


def _work(
    number: int,
    folder: TrialFolder,
    board: Board,
    overwrite: bool,
    prepare: Callable[[], None] | None,
    sweep: int,
) -> tuple[int, str | None]:
    """Completes a trial. Returns its number, and why it failed, if it did. sweep: number of the process of the sweep"""
    _become_worker(sweep)
    try:
        if prepare:
            prepare()
        folder.complete(lambda work, text: board.post(folder.label, work / folder.work, text), overwrite)
    except DrakearmError as error:
        return number, str(error)
    finally:
        board.remove(folder.label)
    return number, None


@lru_cache
def _become_worker(sweep: int) -> None:
    """Prepares this process for trials, unless it is the one of the sweep, which has a single job."""
    if os.getpid() == sweep:
        return
    torch.set_num_threads(1)
    logging.getLogger("drake").setLevel(logging.WARNING)  # Meshcat announces itself when a replay is written
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the sweep ends its workers
    if os.getppid() == sweep:
        threading.Thread(target=_end_with, args=(sweep,), daemon=True).start()


def _end_with(sweep: int) -> None:
    """Ends this process when that of the sweep has ended, which may have been killed."""
    while os.getppid() == sweep:
        time.sleep(_LOOK / 2)
    os._exit(1)


@contextmanager
def _watching(
    folders: Sequence[TrialFolder], ended: Collection[int], board: Board, watch: Watch | None
) -> Iterator[None]:
    """Looks at the board again and again inside the `with` block. ended: the numbers of the trials that have ended."""
    if watch is None:
        yield
        return
    start, stop = time.monotonic(), threading.Event()
    work = {folder.label: folder.work for folder in folders}
    total = sum(work.values())

    def look() -> None:
        with suppress(OSError):  # nobody can see it any more
            while not stop.wait(_LOOK):
                running, elapsed = board.read(), time.monotonic() - start
                done = sum(folders[number].work for number in list(ended))
                done += sum(work[label] * post.done for label, post in running.items())
                left = (total - done) / done * elapsed if done > _LEAST * total and elapsed > _SHORTEST else None
                watch(len(ended), len(folders), running, left)

    thread = threading.Thread(target=look, daemon=True)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()
