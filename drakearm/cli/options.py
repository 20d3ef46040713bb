"""Arguments and options that several commands have, and the checks of their values before any work begins."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from drakearm.errors import shown
from drakearm.experiments.choices import EnvKind, Preset

_LARGEST_SEED = 2**32 - 1  # that NumPy and PyTorch both take
_MOST_BATCHES = 1_000_000


def complete_scenario(incomplete: str) -> list[tuple[str, str]]:
    """The names and descriptions of the shipped scenarios that begin like this, for the shell."""
    from drakearm.experiments.catalog import scenario_descriptions

    return [item for item in scenario_descriptions().items() if item[0].startswith(incomplete)]


def name_or_path(text: str) -> str:
    """An argument that names something. Refuses an empty one, which would mean the current folder."""
    if not text.strip():
        raise typer.BadParameter(f"found {shown(text)}, expected a name or a path.")
    return text


def path(text: str) -> Path:
    """An option that names a file or folder. Refuses an empty one, which would mean the current folder."""
    if not text.strip():
        raise typer.BadParameter(f"found {shown(text)}, expected a path.")
    return Path(text)


def whole_number(least: int, most: int) -> Callable[[str], int]:
    """The parser of an option that is a whole number in a range."""

    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = least - 1
        if not least <= value <= most:
            raise typer.BadParameter(f"found {shown(text)}, expected a whole number from {least} to {most}.")
        return value

    return parse


def duration(text: str) -> float:
    """The parser of an option that is a time in seconds."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise typer.BadParameter(f"found {shown(text)}, expected a number of seconds greater than 0.")
    return value


ScenarioArgument = Annotated[
    str,
    typer.Argument(
        help="A name from `drakearm list`, or the path of a scenario file.",
        metavar="SCENARIO",
        parser=name_or_path,
        autocompletion=complete_scenario,
    ),
]


def scenarios_argument(help: str) -> Any:
    """The argument of a command that takes several scenarios."""
    return typer.Argument(help=help, metavar="SCENARIO...", parser=name_or_path, autocompletion=complete_scenario)


ScenarioArguments = Annotated[list[str], scenarios_argument("Names from `drakearm list`, or paths of scenario files.")]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out",
        help="Folder of the run. [default: runs/SCENARIO]",
        metavar="FOLDER",
        parser=path,
        show_default=False,
    ),
]
OutOfAll = Annotated[
    Path | None,
    typer.Option(
        "--out",
        help="Folder of the run; if there are several scenarios, the folder that holds all runs. [default: runs]",
        metavar="FOLDER",
        parser=path,
        show_default=False,
    ),
]
Seed = Annotated[
    int,
    typer.Option(
        help="Seed of all random numbers: the same seed gives the same result.",
        metavar="NUMBER",
        parser=whole_number(0, _LARGEST_SEED),
    ),
]
Batches = Annotated[
    int | None,
    typer.Option(
        help="Train for this many batches instead of the scenario's number.",
        metavar="NUMBER",
        parser=whole_number(1, _MOST_BATCHES),
        show_default=False,
    ),
]
Env = Annotated[
    EnvKind, typer.Option(help="Train on compiled arms, or on Drake Diagrams: the same arm, but slower to simulate.")
]
PresetName = Annotated[
    Preset | None,
    typer.Option(
        "--preset",
        help="`paper` learns as the paper does: 28 observations, from random weights. [default: the scenario's]",
        show_default=False,
    ),
]
Device = Annotated[
    str | None,
    typer.Option(
        help="Device of PyTorch, `cpu` or `cuda`. [default: `cuda` where there is a graphics card]",
        metavar="DEVICE",
        parser=name_or_path,
        show_default=False,
    ),
]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace the results of an earlier run.")]
LearnedPolicy = Annotated[
    Path | None,
    typer.Option(
        help="A policy that `drakearm learn` wrote. [default: the shipped one for `reaching`]",
        metavar="FILE",
        parser=path,
        show_default=False,
    ),
]
Port = Annotated[
    int | None,
    typer.Option(
        help="Port of the page. [default: the first free one from 7000]",
        metavar="NUMBER",
        parser=whole_number(1024, 65535),
        show_default=False,
    ),
]
Import = Annotated[
    list[str] | None,
    typer.Option(
        "--import",
        help="Import a module, or a .py file, that defines costs of your own, before the scenario is read. "
        "This **runs its code**. Give the option again for another module, and with each command of the run.",
        metavar="MODULE",
        parser=name_or_path,
        show_default=False,
    ),
]
