"""A limb to begin with: the files of an arm with one joint and two muscles, and a movement of it."""

import shutil
from pathlib import Path

from drakearm.errors import StorageError, shown
from drakearm.files.writing import storage

_TEMPLATE = Path(__file__).parent / "new_limb"


def write_limb_template(folder: Path) -> tuple[str, ...]:
    """Writes muscles.yaml, skeleton.urdf and reach.yaml into a folder, which is made, and returns their names.

    Raises StorageError if one of them exists already, or cannot be written.
    """
    files = sorted(_TEMPLATE.iterdir())
    with storage(folder):
        folder.mkdir(parents=True, exist_ok=True)
        for file in files:
            if (folder / file.name).exists():
                raise StorageError(f"{shown(folder / file.name)} exists already: expected another folder.")
        for file in files:
            shutil.copyfile(file, folder / file.name)
    return tuple(file.name for file in files)
