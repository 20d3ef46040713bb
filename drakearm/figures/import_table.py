"""A table of an imported limb for the terminal: how close its muscles' paths are to those of the other program."""

from rich import box
from rich.table import Table
from rich.text import Text

from drakearm.importing.limb import ImportedLimb
from drakearm.importing.report import error_rows

_COLUMNS = ("muscle", "length\nlargest", "\nmedian", "coordinate", "moment arm\nlargest", "\nmedian")


def import_table(limb: ImportedLimb) -> Table:
    """One row per muscle and coordinate."""
    table = Table(
        title=Text(f"Differences to {limb.model.program} in mm"),
        box=box.SIMPLE_HEAD,
        padding=0,
        show_edge=False,
    )
    for column in _COLUMNS:
        table.add_column(column, justify="left" if column in ("muscle", "coordinate") else "right", no_wrap=True)
    for row in error_rows(limb.fits):
        table.add_row(*map(Text, row))
    return table
