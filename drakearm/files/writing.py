"""Writes files whole or not at all: a reader sees the earlier content or the new one, never a part of either."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from drakearm.errors import StorageError, shown


@contextmanager
def replacement(file: Path) -> Iterator[Path]:
    """A path beside `file` to write the new content to. At the end of the `with` block it replaces the file.

    The folder is made if it does not exist. The content is on the disk before the file is replaced, so that a power
    failure leaves the earlier file or the new one. If the block raises an exception, the earlier file stays as it was,
    and nothing of the new one remains. Raises StorageError where the file system does not allow it.
    """
    partial = file.with_name(f".{os.getpid()}.partial")
    try:
        with storage(file):
            file.parent.mkdir(parents=True, exist_ok=True)
            yield partial
            flush_to_disk(partial)
            os.replace(partial, file)
            flush_to_disk(file.parent)
    finally:
        with suppress(OSError):  # it does not exist if it has replaced the file
            partial.unlink()


@contextmanager
def storage(place: Path, what: str = "cannot be written") -> Iterator[None]:
    """Turns what the file system refuses inside the `with` block into a StorageError that names the place."""
    if "\0" in str(place):
        raise StorageError(f"{shown(place)} {what}: a path has no NUL characters.")
    try:
        yield
    except OSError as error:
        raise StorageError(f"{shown(place)} {what}: {error.strerror or error}.") from error


def flush_to_disk(path: Path) -> None:
    """Waits until a file's content, or a folder's list of files, is on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
