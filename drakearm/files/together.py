"""Replaces several files of a folder together: all of them or none, even if the process is killed meanwhile.

The new files are first written into a folder `.staged`. When they are all on the disk, it is renamed `.ready`, and only
then are they moved to their places. `recover` removes what is only staged and completes what was ready.
"""

import os
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from drakearm.errors import RunFolderError, shown
from drakearm.files.writing import flush_to_disk, storage

_STAGED, _READY = ".staged", ".ready"
_REMOVED = ".removed"  # in the folder of new files: names of files and folders to delete before these are moved


@contextmanager
def replaced_together(folder: Path, removed: Iterable[str] = ()) -> Iterator[Path]:
    """A folder to write the new files to. At the end of the `with` block they replace those of `folder`.

    removed: names of files and folders in `folder` that are deleted at the same time. If the block raises an exception,
    `folder` stays as it was. Raises StorageError where the file system does not allow it. Only one process at a time
    may do this: see `locked`.
    """
    staged = folder / _STAGED
    try:
        with storage(folder):
            staged.mkdir()
            yield staged
            (staged / _REMOVED).write_text("\n".join(removed))
            for path in [*staged.rglob("*"), staged]:
                flush_to_disk(path)
            staged.rename(folder / _READY)
            flush_to_disk(folder)
            _move_ready_files(folder)
    finally:
        shutil.rmtree(staged, ignore_errors=True)


def recover(folder: Path) -> None:
    """Makes a folder consistent again after a process was killed in `replaced_together`."""
    with storage(folder):
        if (folder / _STAGED).exists():
            shutil.rmtree(folder / _STAGED)
        if (folder / _READY).exists():
            _move_ready_files(folder)


def _move_ready_files(folder: Path) -> None:
    """Each action can be repeated, so that a process that was killed here can be followed by another one.

    The folder may come from somebody else. So nothing outside of it is touched: names are plain, links not followed.
    """
    ready = folder / _READY
    if (ready / _REMOVED).exists():
        for name in (ready / _REMOVED).read_text().splitlines():
            if name == Path(name).name and not name.startswith("."):
                _remove(folder / name)
        (ready / _REMOVED).unlink()  # from here on, `folder` may hold new files of these names
    paths = sorted(ready.rglob("*"))
    for link in (path for path in [ready, *paths] if path.is_symlink()):
        raise RunFolderError(f"{shown(link)} is a link: expected a file that drakearm wrote.")
    for path in paths:
        place = folder / path.relative_to(ready)
        if path.is_dir():
            if place.is_symlink():
                place.unlink()
            place.mkdir(exist_ok=True)
        else:
            os.replace(path, place)
    flush_to_disk(folder)
    shutil.rmtree(ready)


def _remove(path: Path) -> None:
    """Deletes a file, a folder, or a link but not what it points to, if there is one."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
