"""How far a long command is: a bar in a terminal, else some lines of text."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from drakearm.cli.console import console, say

if TYPE_CHECKING:
    from rich.progress import Progress


class Show(Protocol):
    """Shows how much is done, and a text about it. line: whether this is worth a line where there is no terminal."""

    def __call__(self, text: str, *, done: int = 0, total: int | None = None, line: bool = True) -> None: ...


@contextmanager
def show_progress(title: str, *, transient: bool = False) -> Iterator[Show]:
    """A function that shows the progress of what the title names. transient: the bar disappears at the end."""
    if console.is_terminal:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

        columns = (
            TextColumn(title, markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[text]}", markup=False),
        )
        with Progress(*columns, console=console, transient=transient) as progress:
            yield _moved_bar(progress)
    else:
        yield _printed_lines(title)


def _moved_bar(progress: "Progress") -> Show:
    bar = progress.add_task("", total=None, text="")

    def show(text: str, *, done: int = 0, total: int | None = None, line: bool = True) -> None:
        progress.update(bar, completed=done, total=total, text=text)

    return show


def _printed_lines(title: str) -> Show:
    def show(text: str, *, done: int = 0, total: int | None = None, line: bool = True) -> None:
        if line:
            say(f"{title} {done} of {total}: {text}" if total else f"{title}: {text}")

    return show
