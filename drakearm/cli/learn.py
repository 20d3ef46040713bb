"""`drakearm learn` and `drakearm plan-library`: one policy for many movements."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drakearm.cli.console import console, say
from drakearm.cli.options import Batches, Import, Seed, name_or_path, path
from drakearm.cli.own_code import import_own_code
from drakearm.cli.progress import show_progress

if TYPE_CHECKING:
    from drakearm.learning import BatchReport

LINE_BATCHES = 20  # where there is no terminal, a line is printed each time that this many batches are done
LINE_PLANS = 100

RepertoireArgument = Annotated[
    str, typer.Argument(help="Name of a shipped repertoire, or a file.", metavar="REPERTOIRE", parser=name_or_path)
]


def learn(
    repertoire: RepertoireArgument = "reaching",
    seed: Seed = 0,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="Folder of the files. [default: runs/REPERTOIRE]",
            metavar="FOLDER",
            parser=path,
            show_default=False,
        ),
    ] = None,
    batches: Batches = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue a training that was stopped, with the same result.")
    ] = False,
    imports: Import = None,
) -> None:
    """Learn one policy for many movements: plan a library of them, train, and test on movements never seen.

    Writes library.npz and held_out.npz (the movements), policy.safetensors, training.csv, errors.json and errors.png
    into the folder. A library that is there already is kept. `drakearm move --policy FILE` moves with the policy.
    """
    import_own_code(imports)
    from drakearm.repertoire import learn_repertoire, load_repertoire

    folder = out or Path("runs", load_repertoire(repertoire).name)
    with show_progress("learning") as show:

        def show_round(number: int, rounds: int) -> None:
            show(f"imitated static optimization, round {number} of {rounds}")

        def show_batch(report: "BatchReport") -> None:
            show(
                f"error {report.tracking_error:.3f} rad, {report.seconds_left:.0f} s left",
                done=report.batch,
                total=report.batches,
                line=report.batch % LINE_BATCHES == 0 or report.batch == report.batches,
            )

        errors = learn_repertoire(
            repertoire,
            folder,
            seed=seed,
            batches=batches,
            resume=resume,
            on_planned=_plans_shown(show),
            on_round=show_round,
            on_batch=show_batch,
        )
    _print_errors(errors["held_out"])
    noise = errors["motor_noise"]
    say(
        f"with motor noise of {100 * noise['share']:.0f} % of the excitation, the hand scatters by "
        f"{noise['hand_scatter_median_cm']:.1f} cm (median)"
    )
    say(f"policy in {folder / 'policy.safetensors'}")


def plan_library(
    repertoire: RepertoireArgument = "reaching",
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="File to write. [default: runs/REPERTOIRE/library.npz]",
            metavar="FILE",
            parser=path,
            show_default=False,
        ),
    ] = None,
    imports: Import = None,
) -> None:
    """Plan the movements of a repertoire, on all cores, and keep them in a file.

    Only movements that the muscles can make are kept: static optimization tests each of them. `drakearm learn` plans
    the library itself if its folder has none.
    """
    import_own_code(imports)
    from drakearm.repertoire import load_repertoire
    from drakearm.repertoire.steps import library_of

    loaded = load_repertoire(repertoire)
    file = out or Path("runs", loaded.name, "library.npz")
    if file.exists():
        say(f"{file} is there already")
        return
    with show_progress("planning") as show:
        library_of(loaded, loaded.movements, file, _plans_shown(show))
    say(f"{loaded.movements.count} movements in {file}")


def _plans_shown(show: Callable[..., None]) -> Callable[[int, int], None]:
    """A function that shows how many movements are planned."""

    def show_plan(done: int, total: int) -> None:
        show("movements are planned", done=done, total=total, line=done % LINE_PLANS == 0 or done == total)

    return show_plan


def _print_errors(held_out: dict[str, dict[str, float]]) -> None:
    """A table of the errors in movements that were never seen."""
    from rich.table import Table

    table = Table("in movements never seen", *held_out)
    for label, name, unit in (
        ("mean error, median", "mean_error_median_rad", "rad"),
        ("mean error, 95 % are below", "mean_error_95_rad", "rad"),
        ("hand from target, median", "hand_end_median_cm", "cm"),
        ("hand from target, 95 % are below", "hand_end_95_cm", "cm"),
        ("hand from target, worst", "hand_end_worst_cm", "cm"),
    ):
        table.add_row(label, *(f"{errors[name]:.2g} {unit}" for errors in held_out.values()))
    table.add_row("within 1 cm", *(f"{100 * errors['share_within_1_cm']:.1f} %" for errors in held_out.values()))
    console.print(table)
