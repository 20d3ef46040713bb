"""`drakearm new-limb`."""

from pathlib import Path
from typing import Annotated

import typer

from drakearm.cli.console import say
from drakearm.cli.options import path


def new_limb(
    folder: Annotated[Path, typer.Argument(help="The folder for the new limb.", metavar="FOLDER", parser=path)],
) -> None:
    """Write a limb with one joint and two muscles, to begin with: `docs/limbs.md` says how to go on.

    Writes muscles.yaml, skeleton.urdf and reach.yaml, a movement. Each line that you may change is explained there.
    """
    from drakearm.experiments.limb_template import write_limb_template

    names = write_limb_template(folder)
    say(f"wrote {', '.join(names)} into {folder}")
    say(f"next: drakearm inspect {folder}")
    say(f"then: drakearm run {folder / 'reach.yaml'}")
