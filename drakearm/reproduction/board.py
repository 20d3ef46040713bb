"""What the workers of a sweep do now: they post it in files, which also works between processes and computers."""

import json
import shutil
from pathlib import Path
from typing import NamedTuple

from drakearm.files import replacement


class Post(NamedTuple):
    """The latest news of a trial."""

    done: float  # share of its work
    text: str  # what is done now


class Board:
    """A folder with a file for each trial that runs."""

    def __init__(self, folder: Path):
        self._folder = folder

    def clear(self) -> None:
        """Removes the folder."""
        shutil.rmtree(self._folder, ignore_errors=True)

    def post(self, trial: str, done: float, text: str) -> None:
        """Replaces the post of a trial."""
        with replacement(self._file(trial)) as partial:
            partial.write_text(json.dumps([done, text]), encoding="utf-8")

    def remove(self, trial: str) -> None:
        """Removes the post of a trial that has ended."""
        self._file(trial).unlink(missing_ok=True)

    def read(self) -> dict[str, Post]:
        """The posts of all trials that run, by their names."""
        found = {}
        for file in sorted(self._folder.glob("*.json")):
            try:
                found[file.stem] = Post(*json.loads(file.read_text(encoding="utf-8")))
            except FileNotFoundError:
                pass  # the trial has just ended
        return found

    def _file(self, trial: str) -> Path:
        return self._folder / f"{trial}.json"
