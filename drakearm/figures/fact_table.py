"""A table of two columns for the terminal: the name of a fact, and its value."""

from collections.abc import Mapping

from rich.table import Table
from rich.text import Text


def fact_table(title: str, facts: Mapping[str, str]) -> Table:
    """One row per fact. The texts are shown as they are: square brackets in a name are no markup."""
    table = Table(title=Text(title), show_header=False)
    for name, value in facts.items():
        table.add_row(Text(name), Text(value))
    return table
