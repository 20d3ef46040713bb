"""`drakearm replay`."""

import os
from pathlib import Path
from typing import Annotated

import typer

from drakearm.cli.console import say
from drakearm.cli.folders import existing_run, recorded_run_folder
from drakearm.cli.options import Import, Out, Overwrite, Port, complete_scenario, name_or_path, path
from drakearm.cli.own_code import import_own_code

_PAGE = Path("runs", "replay.html")


def replay(
    run: Annotated[
        str,
        typer.Argument(
            help="A SCENARIO from `drakearm list`, the path of a scenario file, the folder of a run, or a policy: "
            "a .safetensors file, `reaching` or `reaching-delayed`.",
            metavar="RUN",
            parser=name_or_path,
            autocompletion=complete_scenario,
        ),
    ],
    policy: Annotated[
        str | None,
        typer.Option(
            help="Show another policy in this movement: a .safetensors file, `reaching`, `reaching-delayed`, or "
            "`static` for static optimization.",
            metavar="POLICY",
            parser=name_or_path,
            show_default=False,
        ),
    ] = None,
    compare: Annotated[
        str | None,
        typer.Option(
            help="Show this beside it, at the same time: all that RUN and POLICY can be. `static` and policies for "
            "many movements make the movement of RUN.",
            metavar="RUN",
            parser=name_or_path,
            autocompletion=complete_scenario,
            show_default=False,
        ),
    ] = None,
    html: Annotated[
        Path | None,
        typer.Option(
            help="Write the page here. An earlier file is replaced. [default: replay.html in the folder of the run; "
            f"{_PAGE} with a POLICY and with --compare]",
            metavar="FILE",
            parser=path,
            show_default=False,
        ),
    ] = None,
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
    live: Annotated[
        bool, typer.Option("--live", help="Simulate the movement in the browser instead, with another load or target.")
    ] = False,
    port: Port = None,
    out: Out = None,
    overwrite: Overwrite = False,
    imports: Import = None,
) -> None:
    """Show the movement in a browser, in slow motion.

    Writes replay.html: one file that any browser opens, without a connection to the internet. It shows the recording
    of `drakearm evaluate`, with the plan as a translucent arm. Without a run of the scenario, it shows the policy that
    drakearm ships for it: `drakearm replay reach-045`.

    Side by side: `drakearm replay obstacle --compare no-obstacle`, `drakearm replay lift-1kg --compare lift-5kg`,
    `drakearm replay reach-045 --compare static`.

    `--live` opens a page on this computer, with a play button and with sliders for load, target and speed. What you
    change is planned anew, and the movement starts again. Press stop on the page, or Ctrl-C, to end.

    `--png`, `--gif` and `--mp4` need `pip install drakearm[films]` and the program chromium; `--mp4` also ffmpeg.
    """
    _check(run, out, live, port, [compare, html, png, gif, mp4, at])
    import_own_code(imports)
    from drakearm.cli.replay_arguments import is_scenario

    if live:
        _show_live(run, out, policy, port)
        return
    films = [film for film in (gif, mp4) if film]
    if policy or compare or html or not (is_scenario(run) or os.path.isdir(run)):
        page, duration = _write_page(html or _PAGE, run, out, policy, compare)
    else:
        page, duration = _replay_run(run, out, overwrite or bool(png or films))
    if png or films:
        from drakearm.replay.film import SIZE, WIDE, write_film, write_picture

        size = WIDE if compare else SIZE
        if png:
            write_picture(page, png, duration if at is None else min(at, duration), size)
            say(f"picture in {png}")
        for film in films:
            write_film(page, film, duration, size=size)
            say(f"film in {film}")
    say(f"open {page} in a browser")


def _check(run: str, out: Path | None, live: bool, port: int | None, of_files: list[object]) -> None:
    """Refuses options that would have no effect."""
    from drakearm.cli.replay_arguments import is_scenario

    if out and not is_scenario(run):
        raise typer.BadParameter("only the run of a SCENARIO has a folder to choose; --html says where the page goes.")
    if live and any(each is not None for each in of_files):
        raise typer.BadParameter("--live writes no files: expected it without --compare, --html, --png, --gif, --mp4.")
    if port is not None and not live:
        raise typer.BadParameter("expected it with --live.", param_hint="--port")
    if of_files[-1] is not None and of_files[-4] is None:
        raise typer.BadParameter("expected it with --png.", param_hint="--at")


def _replay_run(run: str, out: Path | None, overwrite: bool) -> tuple[Path, float]:
    """Writes the page of a run into its folder. Returns the file, and the duration of the movement, s."""
    from drakearm.experiments import evaluate_step, replay_step
    from drakearm.model import Recording

    with existing_run(run) if os.path.isdir(run) else recorded_run_folder(run, out) as found:
        if not found.path("recording").exists():
            evaluate_step(found)
        found.claim("replay", overwrite)
        return replay_step(found), float(Recording.load(found.path("recording")).t[-1])


def _write_page(file: Path, run: str, out: Path | None, policy: str | None, compare: str | None) -> tuple[Path, float]:
    """Writes the page of one movement, or of two. Returns the file, and the duration of the longer movement, s."""
    from drakearm.cli.replay_arguments import find_shown, titled
    from drakearm.replay import write_comparison, write_replay

    shown = [find_shown(run, out, policy)] + ([find_shown(compare)] if compare else [])
    movements = [each.driver.record(each.planned, each.title) for each in titled(shown)]
    if compare:
        write_comparison(file, *movements)
    else:
        (one,) = movements
        write_replay(file, one.arm, one.recording, load_mass=one.load_mass, obstacle=one.obstacle, caption=one.caption)
    return file, max(float(each.recording.t[-1]) for each in movements)


def _show_live(run: str, out: Path | None, policy: str | None, port: int | None) -> None:
    from drakearm.cli.replay_arguments import find_shown, titled
    from drakearm.repertoire.live_replay import LiveReplay

    (shown,) = titled([find_shown(run, out, policy)])
    page = LiveReplay(shown.planned, shown.driver, port)
    say(f"open {page.meshcat.web_url()} in a browser, and there Open Controls")
    page.Run(say)
