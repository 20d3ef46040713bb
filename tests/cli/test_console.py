"""Names, paths and messages are shown as text, whatever they hold."""

import os
import pty
import sys
from contextlib import suppress
from io import StringIO

import pytest
from rich.table import Table

from drakearm.cli import progress
from drakearm.cli.console import PlainConsole, say, show_error
from drakearm.figures.fact_table import fact_table
from tests.cli.command import start
from tests.cli.test_options import refusal

MARKUP = ("[/red]x", "[bold]x", "a[b", ":smile:", "[link=file:///etc]x[/link]", "[[x]]", "\\[x]", "{x}", "%s")
HOSTILE = "x\x1b[2J\x1b]0;title\x07y\x9b31m\r\x08\u202ez\udcff"  # clears the screen, sets the title, turns text round
HARMLESS = "x[2J]0;titley31mz"


@pytest.fixture
def terminal(monkeypatch):
    """What is printed on a terminal that is 200 characters wide."""
    shown = PlainConsole(file=StringIO(), force_terminal=True, width=200, color_system=None)
    monkeypatch.setattr(sys.modules[say.__module__], "console", shown)
    monkeypatch.setattr(progress, "console", shown)
    return shown


def fill(table, text):
    table.add_column(text)
    table.add_row(text)
    return table


@pytest.mark.parametrize(("given", "seen"), [*((text, text) for text in MARKUP), (HOSTILE, HARMLESS)])
def test_texts_are_shown_as_they_are(terminal, given, seen):
    say(given)
    terminal.print(fact_table(given, {given: given}))
    terminal.print(fill(Table(title=given, caption=given), given))
    with progress.show_progress("planning") as show:
        show(given, done=1, total=2)
    printed = terminal.file.getvalue()
    assert printed.count(seen) >= 8
    for control in "\x1b[2J", "\x1b]", "\x07", "\x9b", "\u202e", "\udcff":
        assert control not in printed


@pytest.mark.parametrize(("given", "seen"), [*((text, text) for text in MARKUP), (HOSTILE, HARMLESS)])
def test_errors_are_shown_as_they_are(capsys, given, seen):
    show_error(given)
    assert capsys.readouterr().err == f"error: {seen}\n"


@pytest.mark.parametrize("text", MARKUP)
def test_usage_errors_are_shown_as_they_are(text):
    assert f"No such command '{text}'" in refusal(text).replace("\\\\", "\\")
    assert text in refusal("run", "x", "--env", text).replace("\\\\", "\\")
    assert f"No such option: --{text.split('=')[0]}" in refusal("run", "x", f"--{text}")


def test_nothing_that_is_typed_commands_the_terminal():
    """In a real terminal, with the colors and moves of the cursor that the command itself makes."""
    for arguments in (["plan", HOSTILE[:-1]], [HOSTILE[:-1]], ["run", "x", "--env", HOSTILE[:-1]]):
        leader, follower = pty.openpty()
        process = start(*arguments, stdin=follower, stdout=follower, stderr=follower)
        os.close(follower)
        printed = b""
        with suppress(OSError):  # how the end is told
            while part := os.read(leader, 1024):
                printed += part
        os.close(leader)
        assert process.wait() in (1, 2)
        assert b"x\\x1b[2J" in printed
        for control in b"\x1b[2J", b"\x1b]", b"\x07", b"\x08", "\u202e".encode(), "\x9b".encode():
            assert control not in printed, printed
