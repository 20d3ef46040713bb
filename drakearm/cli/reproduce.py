"""`drakearm reproduce`."""

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drakearm.cli.console import console, say, show_error
from drakearm.cli.options import Batches, Import, name_or_path, path, whole_number
from drakearm.cli.own_code import import_own_code
from drakearm.cli.progress import show_progress
from drakearm.errors import did_you_mean, shown
from drakearm.reproduction.choices import Backend

if TYPE_CHECKING:
    from rich.table import Table

    from drakearm.reproduction.board import Post
    from drakearm.reproduction.experiment import Experiment
    from drakearm.reproduction.sweep import Watch

_FOLDER = Path("runs", "reproduction")
_LINE_SECONDS = 5.0  # between two lines where there is no terminal
_SHOWN = 2  # trials that are shown at the same time


def reproduce(
    names: Annotated[
        list[str],
        typer.Argument(
            help="`reaching`, `timing`, `lifting`, `obstacle`, or `all` for all four.",
            metavar="EXPERIMENT...",
            parser=name_or_path,
        ),
    ],
    seeds: Annotated[
        int,
        typer.Option(
            help="Train with this many seeds: 0, 1, 2 and so on.", metavar="NUMBER", parser=whole_number(1, 1000)
        ),
    ] = 1,
    jobs: Annotated[
        int | None,
        typer.Option(
            help="Learn and run this many movements at the same time. [default: one for each core]",
            metavar="NUMBER",
            parser=whole_number(1, 10_000),
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help=f"Folder of the reproduction. [default: {_FOLDER}]",
            metavar="FOLDER",
            parser=path,
            show_default=False,
        ),
    ] = None,
    backend: Annotated[
        Backend | None,
        typer.Option(
            help="Work on a cluster: that at DASK_SCHEDULER_ADDRESS or RAY_ADDRESS, or a new one of this computer. All "
            "its computers must see the folder. [default: processes of this computer]",
            show_default=False,
        ),
    ] = None,
    batches: Batches = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Make what was made with other settings again; the rest is kept.")
    ] = False,
    imports: Import = None,
) -> None:
    """Reproduce the experiments of the paper: plan, train, evaluate, and report in report.html.

    Each movement is made by three methods: static optimization, PPO alone as in the paper, and the default. The report
    has a table and the figures of each experiment, next to what the paper found, and links to replays. results.json
    has the same numbers.

    `drakearm reproduce timing` takes some minutes. `drakearm reproduce all --seeds 10` adds spreads between trainings.
    `drakearm reproduce timing --batches 2` only shows how it works.

    Press Ctrl-C to stop. The same command continues: what is finished is not done again, and it ends with the same
    results. More seeds or experiments can be added later in the same way.
    """
    import_own_code(imports)
    experiments = _experiments(names)
    from drakearm.reproduction.reproduction import reproduce

    folder = out or _FOLDER
    try:
        with _shown_progress() as watch:
            made = reproduce(
                experiments,
                folder,
                command=_command(names, seeds, batches, imports),
                seeds=seeds,
                batches=batches,
                jobs=jobs,
                backend=backend,
                overwrite=overwrite,
                prepare=partial(import_own_code, imports) if imports else None,
                watch=watch,
            )
    except KeyboardInterrupt:
        say("stopped: the same command continues")
        raise typer.Exit(130) from None
    if made.earlier:
        say(f"{made.earlier} of {made.earlier + made.completed} trials were finished already")
    if made.report:
        results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
        for experiment in results["experiments"].values():
            console.print(_main_rows(experiment))
        say(f"open {made.report} in a browser")
    for trial, problem in made.failures.items():
        show_error(f"{trial.scenario}, {trial.method}, seed {trial.seed}: {problem}")
    if made.failures:
        raise typer.Exit(1)


def _experiments(names: Sequence[str]) -> "list[Experiment]":
    """The experiments with these names, each once. Raises BadParameter if there is none with a name."""
    from drakearm.reproduction.catalog import EXPERIMENTS

    for name in names:
        if name not in (*EXPERIMENTS, "all"):
            known = ", ".join(EXPERIMENTS)
            raise typer.BadParameter(f"found {shown(name)}{did_you_mean(name, EXPERIMENTS)}, expected {known} or all.")
    chosen = dict.fromkeys(each for name in names for each in (EXPERIMENTS if name == "all" else [name]))
    return [EXPERIMENTS[name] for name in chosen]


def _command(names: Sequence[str], seeds: int, batches: int | None, imports: Sequence[str] | None) -> str:
    """The command with those options on which the results depend."""
    options = {"--seeds": seeds, "--batches": batches}
    words = [f"{option} {value}" for option, value in options.items() if value is not None]
    return " ".join(["drakearm reproduce", *names, *words, *(f"--import {module}" for module in imports or ())])


@contextmanager
def _shown_progress() -> "Iterator[Watch]":
    """A function that shows the progress of a sweep: a bar in a terminal, else a line every few seconds."""
    with show_progress("reproducing") as show:
        printed = time.monotonic()

        def watch(done: int, total: int, running: "Mapping[str, Post]", seconds_left: float | None) -> None:
            nonlocal printed
            line = time.monotonic() - printed >= _LINE_SECONDS
            printed = time.monotonic() if line else printed
            parts = [f"{label} ({post.text})" for label, post in running.items()][:_SHOWN]
            parts += [f"{len(running) - _SHOWN} more"] if len(running) > _SHOWN else []
            parts += [f"about {_duration(seconds_left)} left"] if seconds_left is not None else []
            show("; ".join(parts) or "starting", done=done, total=total, line=line)

        yield watch


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def _main_rows(experiment: Mapping[str, Any]) -> "Table":
    """The quantities of an experiment that the paper reports too."""
    from rich.table import Table
    from rich.text import Text

    from drakearm.reproduction.trial import Method

    table = Table("quantity", "paper", *Method, title=Text(experiment["title"]))
    rows = [row for row in experiment["rows"] if row["paper"]]
    for group, some in groupby(rows, key=lambda row: row["group"]):
        table.add_section()
        if group:
            table.add_row(Text(group, "bold"))
        for row in some:
            values = [row["values"].get(method, {}).get("text", "") for method in Method]
            quantity = f"{row['quantity']}, {row['note']}" if row["note"] else row["quantity"]
            table.add_row(*map(Text, (quantity, row["paper"], *values)))
    return table
