"""Arguments and options that several commands have."""

from pathlib import Path
from typing import Annotated

import typer

from drakearm.experiments.choices import EnvKind


def complete_scenario(incomplete: str) -> list[tuple[str, str]]:
    """The names and descriptions of the shipped scenarios that begin like this, for the shell."""
    from drakearm.experiments.catalog import scenario_descriptions

    return [item for item in scenario_descriptions().items() if item[0].startswith(incomplete)]


ScenarioArgument = Annotated[
    str,
    typer.Argument(
        help="A name from `drakearm list`, or the path of a scenario file.",
        metavar="SCENARIO",
        autocompletion=complete_scenario,
    ),
]
Out = Annotated[
    Path | None, typer.Option("--out", help="Folder of the run. [default: runs/SCENARIO]", show_default=False)
]
Seed = Annotated[int, typer.Option(help="Seed of all random numbers: the same seed gives the same result.")]
Batches = Annotated[
    int | None,
    typer.Option(min=1, help="Train for this many batches instead of the scenario's number.", show_default=False),
]
Env = Annotated[
    EnvKind, typer.Option(help="Train on compiled arms, or on Drake Diagrams: the same arm, but slower to simulate.")
]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace the results of an earlier run.")]
Import = Annotated[
    list[str] | None,
    typer.Option(
        "--import",
        help="Import a module, or a .py file, that defines costs of your own, before the scenario is read. "
        "This **runs its code**. Give the option again for another module, and with each command of the run.",
        metavar="MODULE",
        show_default=False,
    ),
]
