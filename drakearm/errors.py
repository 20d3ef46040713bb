"""The errors that a user of drakearm can cause. Each message says what is wrong, where, and what was expected."""

import re
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path
from reprlib import Repr
from typing import Any

LONGEST_MESSAGE = 300  # characters: a message is read at a glance, whatever the file holds that it quotes
_LONGEST_PATH, _LONGEST_VALUE = 110, 40
# Unicode's categories of what a terminal obeys instead of showing it: control characters, changes of direction, halves
# of characters, line breaks.
UNPRINTABLE = ("Cc", "Cf", "Cs", "Zl", "Zp")
_SHORT = Repr()  # of lists and mappings, the first few elements
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff]+")


class DrakearmError(Exception):
    """Base of every error that drakearm raises on purpose.

    The message is one line of at most LONGEST_MESSAGE characters. If it is longer, the middle is left out. Line breaks
    and other control characters become spaces, so that a text from a file cannot change the terminal.
    """

    def __init__(self, message: str) -> None:
        super().__init__(_shortened(_CONTROL.sub(" ", message), LONGEST_MESSAGE))


class ArmError(DrakearmError):
    """An arm folder that cannot be read or does not describe a valid arm."""


class PathError(ArmError):
    """Muscle paths that cannot become functions of the joint angles."""


class ImportingError(DrakearmError):
    """A model of another program that cannot be imported, or not in the way that was asked for."""


class EquilibriumError(DrakearmError):
    """A muscle whose fiber and tendon cannot be in equilibrium, or a posture that the muscles are too weak to hold."""


class DerivativeError(DrakearmError):
    """A quantity that cannot be computed with automatic differentiation, or not in this mode of its system."""


class ScenarioError(DrakearmError):
    """An unknown scenario or a scenario file with a wrong, missing or unknown field."""


class PlanningError(DrakearmError):
    """An optimal-control problem without a solution, or one for which the solver found no solution."""


class FilmError(DrakearmError):
    """A picture or film of a replay that cannot be made, for example because a program is not installed."""


class TaskError(DrakearmError, ValueError):
    """A task, sense, reward or start that environments cannot use."""


class StateError(DrakearmError, ValueError):
    """A state or excitation of the wrong shape or with values that are not finite."""


class ActionError(DrakearmError, ValueError):
    """An action of the wrong shape or with values that are not finite."""


class TrainingError(DrakearmError):
    """A training that cannot start or that diverged."""


class PolicyFileError(DrakearmError):
    """A policy file that cannot be read, or that was trained for another task."""


class RunFolderError(DrakearmError):
    """A run folder that lacks a file, has a damaged one, or has one that does not belong to the others."""


class StorageError(DrakearmError):
    """A file that the file system does not let us write, for example because the disk is full."""


class SweepError(DrakearmError):
    """A sweep of many trials that cannot start, or whose workers ended before their time."""


class OwnCodeError(DrakearmError):
    """A user's own module or file, given with `--import`, that cannot be found or fails when it is imported."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The text " (did you mean X?)", where X is the most similar known name; empty if none is similar."""
    return "".join(f" (did you mean {close}?)" for close in get_close_matches(name[:100], known, n=1))


def listed(names: Iterable[str], length: int = 120) -> str:
    """Names, one after the other; of many, the first and the last ones, and how many are between them."""
    rest = list(names)
    if len(", ".join(rest)) <= length:
        return ", ".join(rest)
    first: list[str] = []
    last: list[str] = []
    left = length
    while len(rest[0]) + len(rest[-1]) + 4 <= left:
        first, last, rest = [*first, rest[0]], [rest[-1], *last], rest[1:-1]
        left -= len(first[-1]) + len(last[0]) + 4
    return ", ".join([*first, f"{len(rest)} more", *last])


def shown(value: Any) -> str:
    """A value as messages show it: as Python writes it, but short. Of a long path, the end is shown."""
    if isinstance(value, Path):
        text = str(value)
        return text if len(text) <= _LONGEST_PATH else "..." + text[-_LONGEST_PATH:]
    try:
        text = _SHORT.repr(value)
    except ValueError:  # Python refuses to write an integer with thousands of digits
        text = "a number with thousands of digits"
    return _shortened(text, _LONGEST_VALUE)


def _shortened(text: str, length: int) -> str:
    """A text of at most this length: of a longer one, the beginning and the end."""
    if len(text) <= length:
        return text
    kept = length - 3
    return text[: kept - kept // 2] + "..." + text[len(text) - kept // 2 :]
