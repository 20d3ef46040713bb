"""A folder in which only one process at a time works."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from drakearm.errors import RunFolderError, shown
from drakearm.files.writing import storage

_held: set[int] = set()  # descriptors of the folders that this process has locked


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Locks a folder that exists. The lock ends with the `with` block, or with the process, however that ends.

    Raises RunFolderError if it is locked already. On a file system without locks, nothing is locked.
    """
    with storage(folder, "cannot be opened"):
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise RunFolderError(
                f"Another drakearm command is at work in {shown(folder)}: wait until it ends, "
                "or choose another folder with --out."
            ) from error
        except OSError:
            pass  # the file system has no locks
        _held.add(descriptor)
        yield
    finally:
        _held.discard(descriptor)
        os.close(descriptor)


def _close_in_child() -> None:
    """A forked process shares the lock, and would keep it when its parent is killed."""
    for descriptor in _held:
        with suppress(OSError):
            os.close(descriptor)
    _held.clear()


os.register_at_fork(after_in_child=_close_in_child)
