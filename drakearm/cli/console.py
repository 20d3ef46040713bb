"""What the command line prints. Names, paths and messages are shown as they are, and cannot change the terminal."""

import unicodedata
from collections.abc import Iterable
from contextlib import suppress
from typing import Any

from rich.console import Console
from rich.segment import Segment
from rich.text import Text

from drakearm.errors import UNPRINTABLE


class PlainConsole(Console):
    """A console that shows text as it is: square brackets are no markup, colons make no emoji.

    Control characters in a text, such as those that begin a terminal's commands, are left out.
    """

    def __init__(self, **options: Any):
        super().__init__(markup=False, emoji=False, **options)

    def render(self, *arguments: Any, **options: Any) -> Iterable[Segment]:
        for segment in super().render(*arguments, **options):
            yield segment if segment.control else Segment(_printable(segment.text), segment.style)


console = PlainConsole()


def say(text: str) -> None:
    """Prints a line. Where it is longer than the terminal is wide, the terminal wraps it."""
    console.print(text, soft_wrap=True)


def show_error(message: str) -> None:
    """Prints an error on stderr, if that can be written to."""
    with suppress(OSError):
        PlainConsole(stderr=True).print(Text.assemble(("error:", "red"), f" {message}"), soft_wrap=True)


def _printable(text: str) -> str:
    if text.isprintable():
        return text
    return "".join(c for c in text if c == "\n" or unicodedata.category(c) not in UNPRINTABLE)
