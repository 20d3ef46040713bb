"""`drakearm list`."""

from rich.table import Table
from rich.text import Text

from drakearm.cli.console import console


def list_scenarios() -> None:
    """Show the movements that drakearm ships.

    `drakearm plan NAME` plans one of them, `drakearm run NAME` learns it too.
    """
    from drakearm.experiments.catalog import scenario_descriptions

    table = Table("scenario", "what moves")
    for name, description in scenario_descriptions().items():
        table.add_row(Text(name), Text(description))
    console.print(table)
