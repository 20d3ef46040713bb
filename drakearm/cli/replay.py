"""`drakearm replay`."""

import os
from pathlib import Path
from typing import Annotated

import typer

from drakearm.cli.console import say
from drakearm.cli.folders import existing_run, learned_run_folder
from drakearm.cli.options import Import, Out, Overwrite, complete_scenario, name_or_path, path
from drakearm.cli.own_code import import_own_code


def replay(
    run: Annotated[
        str,
        typer.Argument(
            help="A SCENARIO from `drakearm list`, the path of a scenario file, or the folder of a run.",
            metavar="RUN",
            parser=name_or_path,
            autocompletion=complete_scenario,
        ),
    ],
    out: Out = None,
    overwrite: Overwrite = False,
    png: Annotated[
        Path | None,
        typer.Option(help="Also write a picture of the page.", metavar="FILE", parser=path, show_default=False),
    ] = None,
    at: Annotated[
        float | None,
        typer.Option(help="Time of the picture, in s. [default: the end]", metavar="S", min=0.0, show_default=False),
    ] = None,
    gif: Annotated[
        Path | None,
        typer.Option(help="Also write a film for web pages.", metavar="FILE", parser=path, show_default=False),
    ] = None,
    mp4: Annotated[
        Path | None, typer.Option(help="Also write a film for talks.", metavar="FILE", parser=path, show_default=False)
    ] = None,
    imports: Import = None,
) -> None:
    """Show the movement in a browser, in slow motion.

    Writes replay.html: one file that any browser opens, without a connection to the internet. It shows the recording
    of `drakearm evaluate`, with the plan as a translucent arm. Without a run of the scenario, it shows the policy that
    drakearm ships for it: `drakearm replay reach-045`.

    `--png`, `--gif` and `--mp4` need `pip install drakearm[films]` and the program chromium; `--mp4` also ffmpeg.
    """
    import_own_code(imports)
    from drakearm.experiments import evaluate_step, replay_step

    with existing_run(run) if os.path.isdir(run) else learned_run_folder(run, out) as found:
        if not found.path("recording").exists():
            evaluate_step(found)
        found.claim("replay", overwrite or any((png, gif, mp4)))
        page = replay_step(found)
        if png or gif or mp4:
            from drakearm.model import Recording
            from drakearm.replay.film import write_film, write_picture

            duration = float(Recording.load(found.path("recording")).t[-1])
            if png:
                write_picture(page, png, min(duration if at is None else at, duration))
                say(f"picture in {png}")
            for film in (gif, mp4):
                if film:
                    write_film(page, film, duration)
                    say(f"film in {film}")
        say(f"open {page} in a browser")
