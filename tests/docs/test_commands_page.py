"""The page of the commands lists all of them."""

import re
from pathlib import Path

from drakearm.cli import app

PAGE = Path(__file__).parents[2] / "docs" / "commands.md"


def test_the_table_has_each_command_once():
    listed = re.findall(r"^\| `([a-z-]+)` \|", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert sorted(listed) == sorted(command.name for command in app.registered_commands)
