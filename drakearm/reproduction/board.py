"""What the trials of a sweep are at: their workers post it in files, which also works between computers."""

import json
import shutil
from pathlib import Path
from typing import NamedTuple

from drakearm.files import replacement


class Post(NamedTuple):
    """The latest news of a trial."""

    done: float  # share of its work; 1 if it has ended
    text: str  # what is done now


class Board:
    """A folder with a file for each trial that has begun."""

    def __init__(self, folder: Path):
        self._folder = folder

    def clear(self) -> None:
        """Removes the folder."""
        shutil.rmtree(self._folder, ignore_errors=True)

    def post(self, trial: str, done: float, text: str) -> None:
        """Replaces the post of a trial."""
        with replacement(self._file(trial)) as partial:
            partial.write_text(json.dumps([done, text]), encoding="utf-8")

    def read(self) -> dict[str, Post]:
        """The posts of all trials that have begun, by their names."""
        return {file.stem: Post(*json.loads(file.read_text(encoding="utf-8"))) for file in self._folder.glob("*.json")}

    def _file(self, trial: str) -> Path:
        return self._folder / f"{trial}.json"
