"""`drakearm inspect`."""

from pathlib import Path
from typing import Annotated

import typer

from drakearm.cli.console import console, say
from drakearm.cli.new_file import prepare_new_file
from drakearm.cli.options import name_or_path, path


def inspect(
    arm: Annotated[
        str, typer.Argument(help="arm14, or the folder of your own arm.", metavar="ARM", parser=name_or_path)
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="The picture, a .png file. [default: ARM.png]",
            metavar="FILE",
            parser=path,
            show_default=False,
        ),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an earlier picture.")] = False,
) -> None:
    """Look at an arm's muscles: a table of their numbers, and a picture of lengths, moment arms and curves.

    `drakearm inspect arm14` shows the arm of the paper. A folder with a muscles.yaml of your own is checked first: an
    error names the field that is wrong.
    """
    from drakearm.figures import muscle_table, write_arm_picture
    from drakearm.model.inspection import inspect_arm
    from drakearm.model.loader import load_limb

    limb = load_limb(arm)
    file = out or Path(f"{limb.arm.name}.png")
    prepare_new_file(file, "picture", ".png", overwrite)
    inspection = inspect_arm(*limb)
    write_arm_picture(inspection, file)
    console.print(muscle_table(inspection))
    say(f"open {file} for lengths, moment arms and curves")
