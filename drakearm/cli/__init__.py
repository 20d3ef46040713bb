"""The command `drakearm`: from a scenario's name to a plan, a policy, its metrics and a replay in the browser.

Each command is one file here. It imports Drake, PyTorch and matplotlib when it runs, so that `--help` and `list` answer
at once.
"""

import logging
import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from drakearm.cli import (
    evaluate,
    export,
    import_limb,
    inspect,
    learn,
    live,
    move,
    new_limb,
    plan,
    replay,
    reproduce,
    run,
    train,
)
from drakearm.cli.console import console, show_error
from drakearm.cli.list import list_scenarios
from drakearm.cli.streams import abandon_output, prepare_streams
from drakearm.errors import DrakearmError, shown

# Typer imports pydantic to convert a flag that is not given, unless its default is False. That would double the time.
_QUICK_FLAGS = {"help": False, "install_completion": False, "show_completion": False, "list": {"help": False}}

app = typer.Typer(
    no_args_is_help=True,
    context_settings={"default_map": _QUICK_FLAGS},
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    help="""A human arm with 14 Hill-type muscles in Drake.

    A run has four steps: **plan** finds the optimal joint movement, **train** learns muscle excitations that follow it,
    **evaluate** measures how well, **replay** shows it in a browser. `drakearm run SCENARIO` does the four in a row.

    `drakearm reproduce` does this for the experiments of the paper, and reports its results beside the paper's.

    Start with `drakearm list`, then `drakearm run timing-0.7s`. `drakearm plan --help` explains one step.
    """,
)
app.command("list")(list_scenarios)
app.command("inspect")(inspect.inspect)
app.command("import")(import_limb.import_limb)
app.command("plan")(plan.plan)
app.command("train")(train.train)
app.command("evaluate")(evaluate.evaluate)
app.command("replay")(replay.replay)
app.command("export")(export.export)
app.command("run")(run.run)
app.command("move")(move.move)
app.command("live")(live.live)
app.command("plan-library")(learn.plan_library)
app.command("learn")(learn.learn)
app.command("new-limb")(new_limb.new_limb)
app.command("reproduce")(reproduce.reproduce)


def _show_version(asked: bool) -> None:
    if asked:
        from drakearm.version import __version__

        console.print(f"drakearm {__version__}", highlight=False)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    pass


def main() -> None:
    """Entry point. An error that the user or the computer causes is one sentence on stderr and exit code 1.

    The lines below it are its notes, for example the other problems of a file. Ctrl-C is exit code 130. Any other
    exception is a bug, so it is shown with its traceback.
    """
    prepare_streams()
    # Meshcat announces itself when a replay is written. A filter, because Drake sets its level when it is imported.
    logging.getLogger("drake").addFilter(lambda record: record.levelno >= logging.WARNING)
    try:
        app()
    except DrakearmError as error:
        message = "\n       ".join([str(error), *getattr(error, "__notes__", [])])
    except OSError as error:
        message = _refusal(error)
    except MemoryError:
        message = "There is not enough memory."
    except RecursionError:
        message = "Something is nested too deeply: expected fewer lists, mappings or calls inside each other."
    except KeyboardInterrupt:
        sys.exit(130)
    except SystemError as error:  # what Numba makes of Ctrl-C while it loads or compiles a function
        if not isinstance(error.__cause__, KeyboardInterrupt):
            raise
        sys.exit(130)
    else:
        return
    show_error(message)
    abandon_output()
    sys.exit(1)


def _refusal(error: OSError) -> str:
    """A sentence about what the operating system refuses, for example because the disk is full."""
    place = shown(Path(os.fsdecode(error.filename))) if isinstance(error.filename, str | bytes) else "The command"
    return f"{place} failed: {error.strerror or error}."
