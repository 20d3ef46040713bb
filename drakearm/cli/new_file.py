"""A file that a command writes outside of a run's folder."""

import os
from pathlib import Path

from drakearm.errors import StorageError, shown


def prepare_new_file(file: Path, what: str, suffix: str, overwrite: bool) -> None:
    """Makes the file's folder. what: the file is, for messages. suffix: in which its name must end.

    Raises StorageError if the command may not write it.
    """
    from drakearm.files.writing import storage

    if file.suffix != suffix:
        raise StorageError(f"{shown(file)} is no name for a {what}: expected one that ends in {suffix}.")
    if os.path.lexists(file) and not overwrite:
        raise StorageError(
            f"{shown(file)} exists already: choose another file with --out, or replace it with --overwrite."
        )
    with storage(file):
        file.parent.mkdir(parents=True, exist_ok=True)
