"""`drakearm import`."""

import math
from pathlib import Path
from typing import Annotated

import typer

from drakearm.cli.console import console, say
from drakearm.cli.options import path
from drakearm.errors import shown


def import_limb(
    model: Annotated[
        Path, typer.Argument(help="A model of OpenSim (.osim) or MuJoCo (.xml).", metavar="MODEL", parser=path)
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="The folder of the limb. [default: the name of MODEL]",
            metavar="FOLDER",
            parser=path,
            show_default=False,
        ),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            "--only",
            help="Keep these bodies, with commas between them. A body whose parent is not kept is fixed in the world. "
            "[default: all bodies]",
            metavar="BODY,...",
            show_default=False,
        ),
    ] = None,
    lock: Annotated[
        list[str] | None,
        typer.Option(
            "--lock",
            help="Coordinates that do not move, with commas between them, and their values in degrees, or in m if they "
            "shift.",
            metavar="COORDINATE=DEG,...",
            show_default=False,
        ),
    ] = None,
    freeze: Annotated[
        list[str] | None,
        typer.Option(
            "--freeze",
            help="Joints of OpenSim, such as a knee, that shall only turn. What else they do stays as it is at this "
            "angle.",
            metavar="JOINT=DEG,...",
            show_default=False,
        ),
    ] = None,
    tip: Annotated[
        str | None,
        typer.Option(
            "--tip",
            help="The point whose path is planned: a body, and where in it, in m. [default: the mass center of the "
            "most distal body]",
            metavar="BODY=X,Y,Z",
            show_default=False,
        ),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an earlier import.")] = False,
) -> None:
    """Make a limb of a musculoskeletal model: a folder that all commands take instead of arm14.

    It needs OpenSim or MuJoCo: `pip install drakearm[import]`. Muscle lengths are asked from that program over the
    whole joint range, with its wrapping, and fitted. A table shows how close the fit is. What a limb cannot have is
    refused with a sentence that names it.

    `drakearm import arm26.osim`, then `drakearm inspect arm26`.
    """
    from drakearm.figures.import_table import import_table
    from drakearm.importing import import_limb, limb_name, what_to_know, write_limb

    bodies = [name for text in only or () for name in text.split(",") if name]
    limb = import_limb(model, bodies, _values(lock, "--lock"), _values(freeze, "--freeze"), _point(tip))
    folder = out or Path(limb_name(model.stem))
    write_limb(limb, folder, overwrite)
    console.print(import_table(limb))
    for sentence in what_to_know(limb):
        say(f"- {sentence}")
    say(f"wrote {folder}: `drakearm inspect {folder}` shows its muscles, report.md says what was changed")


def _values(texts: list[str] | None, option: str) -> dict[str, float]:
    values = {}
    for text in (part for several in texts or () for part in several.split(",")):
        name, _, number = text.partition("=")
        value = _number(number)
        if not name or value is None:
            raise typer.BadParameter(f"found {option} {shown(text)}, expected a name, = and a number.")
        values[name] = value
    return values


def _point(text: str | None) -> tuple[str, tuple[float, float, float]] | None:
    if text is None:
        return None
    name, _, numbers = text.partition("=")
    point = [_number(number) for number in numbers.split(",")]
    if not name or len(point) != 3 or None in point:
        raise typer.BadParameter(f"found --tip {shown(text)}, expected a body, = and three numbers.")
    x, y, z = (value or 0.0 for value in point)
    return name, (x, y, z)


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
