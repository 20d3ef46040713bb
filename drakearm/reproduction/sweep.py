"""A sweep: many trials in parallel, each in its own folder."""

import logging
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
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
_LEAST, _SHORTEST = 0.05, 5.0  # share of the work that must be done, and time in s, before the rest is estimated


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
    tasks = [delayed(_work)(folder, board, overwrite, prepare, os.getpid()) for folder in ordered]
    try:
        with workers(backend, jobs), _watching(ordered, board, watch):
            problems = Parallel(batch_size=1, pre_dispatch="n_jobs")(tasks)
    except TerminatedWorkerError as error:
        raise SweepError(
            "A worker ended unexpectedly: the same command continues; "
            "with fewer --jobs, if there was too little memory."
        ) from error
    finally:
        board.clear()
    return {folder.trial: problem for folder, problem in zip(ordered, problems, strict=True) if problem is not None}


def _work(
    folder: TrialFolder, board: Board, overwrite: bool, prepare: Callable[[], None] | None, sweep: int
) -> str | None:
    """Completes a trial. Returns why it failed, if it did. sweep: number of the process of the sweep."""
    _become_worker(sweep)
    try:
        if prepare:
            prepare()
        folder.complete(lambda work, text: board.post(folder.label, work / folder.work, text), overwrite)
    except DrakearmError as error:
        return str(error)
    finally:
        board.post(folder.label, 1.0, "ended")
    return None


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
def _watching(folders: Sequence[TrialFolder], board: Board, watch: Watch | None) -> Iterator[None]:
    """Looks at the board again and again inside the `with` block."""
    if watch is None:
        yield
        return
    start, stop = time.monotonic(), threading.Event()
    work = {folder.label: folder.work for folder in folders}
    total = sum(work.values())

    def look() -> None:
        with suppress(OSError):  # nobody can see it any more
            while not stop.wait(_LOOK):
                posts = {label: post for label, post in board.read().items() if label in work}
                elapsed = time.monotonic() - start
                done = sum(work[label] * post.done for label, post in posts.items())
                left = (total - done) / done * elapsed if done > _LEAST * total and elapsed > _SHORTEST else None
                running = {label: post for label, post in posts.items() if post.done < 1.0}
                watch(len(posts) - len(running), len(folders), running, left)

    thread = threading.Thread(target=look, daemon=True)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()
