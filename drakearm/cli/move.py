"""`drakearm move`."""

import time
from pathlib import Path
from typing import Annotated

import typer

from drakearm.cli.console import console, say
from drakearm.cli.options import LearnedPolicy, duration, path
from drakearm.cli.quick_imports import quick_imports

_FOLDER = Path("runs", "move")


def move(
    to: Annotated[
        tuple[float, float],
        typer.Option(
            help="Where the hand goes: x forward and y up, in m. The shoulder is at -0.02 0.79.", metavar="X Y"
        ),
    ],
    start: Annotated[
        tuple[float, float],
        typer.Option("--from", help="Angles of shoulder and elbow at the start, in degrees.", metavar="DEG DEG"),
    ] = (-20.0, 80.0),
    seconds: Annotated[
        float, typer.Option("--in", help="How long the movement takes, in s.", metavar="S", parser=duration)
    ] = 0.6,
    load: Annotated[
        float, typer.Option(help="Mass in the hand, in kg. The policy is not told.", metavar="KG", min=0.0, max=1000.0)
    ] = 0.0,
    avoid: Annotated[
        tuple[float, float, float] | None,
        typer.Option(
            help="A bar that the arm keeps clear of: x and y of its middle, and its radius, in m.",
            metavar="X Y R",
            show_default=False,
        ),
    ] = None,
    policy: LearnedPolicy = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help=f"Folder of the files. [default: {_FOLDER}]",
            metavar="FOLDER",
            parser=path,
            show_default=False,
        ),
    ] = None,
) -> None:
    """Move the hand to a place, at once and without training.

    Optimal control plans the movement, and static optimization tests whether the muscles can make it. Then one policy,
    which has learned many other movements, drives the 14 muscles. Writes the plan, pictures, the recording and a
    replay for the browser.

    `drakearm move --to 0.4 0.6` reaches forward. `drakearm move --to 0.3 0.5 --load 1.5 --in 0.8` carries 1.5 kg.
    """
    began = time.perf_counter()
    with quick_imports():
        # First, because Drake's templates look at all modules and at all imports that wait: there are few of them yet.
        import drakearm.systems  # noqa: F401
        from drakearm.repertoire.move import move
        from drakearm.repertoire.shipped import policy_and_repertoire

    chosen, repertoire = policy_and_repertoire(policy)
    made = move(repertoire, chosen, to, start_deg=start, duration=seconds, load_mass=load, avoid=avoid)
    files = made.save(out or _FOLDER)
    from rich.table import Table

    table = Table("quantity", *made.task.arm.coordinates, "hand")
    errors = made.metrics
    table.add_row("mean error", *(f"{error:.4f} rad" for error in errors["tracking_error_mean"]), "")
    end = [f"{error:.4f} rad" for error in errors["end_error"]]
    table.add_row("end error", *end, f"{errors['hand_end_error_cm']:.2f} cm")
    console.print(table)
    say(f"made in {time.perf_counter() - began:.1f} s; open {files[-1]} in a browser")
