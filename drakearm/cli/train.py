"""`drakearm train`."""

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drakearm.cli.console import say
from drakearm.cli.folders import newly_planned_run_folder, opened, planned_run_folder, say_removed
from drakearm.cli.interrupt import delayed_interrupt
from drakearm.cli.options import (
    Batches,
    Device,
    Env,
    Import,
    OutOfAll,
    Overwrite,
    PresetName,
    ScenarioArguments,
    Seed,
    path,
)
from drakearm.cli.own_code import import_own_code
from drakearm.cli.progress import show_progress
from drakearm.experiments.choices import EnvKind, Preset

if TYPE_CHECKING:
    from drakearm.experiments import RunFolder
    from drakearm.learning import BatchReport

LINE_BATCHES = 10  # where there is no terminal, a line is printed each time that this many batches are done


def train(
    scenarios: ScenarioArguments,
    seed: Seed = 0,
    out: OutOfAll = None,
    batches: Batches = None,
    env: Env = EnvKind.compiled,
    preset: PresetName = None,
    overwrite: Overwrite = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue a training that was stopped; begin, if there is none.")
    ] = False,
    meshcat: Annotated[
        bool, typer.Option("--meshcat", help="Show the first movement of the present policy in a browser.")
    ] = False,
    tensorboard: Annotated[
        Path | None,
        typer.Option(
            help="Also write the progress for TensorBoard, into this folder.",
            metavar="FOLDER",
            parser=path,
            show_default=False,
        ),
    ] = None,
    device: Device = None,
    imports: Import = None,
) -> None:
    """Learn muscle excitations that follow the plan.

    Needs the plan in the run's folder: `drakearm plan SCENARIO` comes first. Writes policy.safetensors (what was
    learned), training.csv (one row per batch) and training.json (preset, seed, settings, how far it came).

    With several scenarios, one policy learns all of them: `drakearm train reach-000 reach-090 --out runs/two`. Each has
    its own run in a folder with its name, and is planned first if it is not planned yet. All runs get the policy, and
    training.json lists the scenarios. They must have the same arm, senses, reward and training settings.
    `drakearm evaluate reach-000 reach-090 --out runs/two` then shows the errors of all.

    `--preset paper` learns to follow the same plan as the paper does. The run keeps the preset, for `drakearm evaluate`
    and for later trainings; `--preset drakearm` changes it back.

    Press Ctrl-C to stop after the current batch: the policy so far is kept, and `drakearm evaluate` measures it.
    `--resume` continues a training that was stopped, by Ctrl-C or in any other way. It ends with the same policy, bit
    for bit, as if it had not been stopped.
    """
    import_own_code(imports)
    if resume and overwrite:
        raise typer.BadParameter("found --resume and --overwrite, expected one of them.")
    several = len(set(scenarios)) > 1
    with opened(newly_planned_run_folder if several else planned_run_folder, scenarios, out) as runs:
        outdated = [file for run in runs for file in run.claim("train", overwrite or resume)]
        train_run(runs, seed, batches, env, preset, resume, meshcat, tensorboard, device)
        say_removed([file for file in outdated if not file.exists()])
        if several:
            say(f"one policy for {len(runs)} movements, kept in {_places(runs)}")


def train_run(
    runs: "list[RunFolder]",
    seed: int,
    batches: int | None,
    env: EnvKind,
    preset: Preset | None = None,
    resume: bool = False,
    meshcat: bool = False,
    tensorboard: Path | None = None,
    device: str | None = None,
) -> None:
    """Trains one policy in the folders of runs and shows the progress. Exits with code 130 if Ctrl-C is pressed.

    preset: replaces the one in the run's scenario. resume: whether to continue an earlier training, if there is one.
    meshcat: whether to show the movement meanwhile. tensorboard: a folder for its files. device: of PyTorch.
    """
    from drakearm.experiments import train_step

    run = runs[0]
    view = None
    if meshcat:
        from drakearm.experiments.training_view import TrainingView
        from drakearm.learning import Policy

        view = TrainingView(run.task(run.scenario(preset)))
        say(f"open {view.url} in a browser")

    earlier = run.read_json("training", "train") if resume and run.path("training").exists() else None
    last: BatchReport | None = None
    try:
        with ExitStack() as stack:
            log = None
            if tensorboard is not None:
                from drakearm.learning.tensorboard import tensorboard_log

                log = stack.enter_context(tensorboard_log(tensorboard))
            interrupt_now = stack.enter_context(delayed_interrupt("after this batch"))
            show = stack.enter_context(show_progress("training"))

            def show_round(number: int, rounds: int) -> None:
                show(f"imitated static optimization, round {number} of {rounds}")
                interrupt_now()

            def show_batch(report: "BatchReport") -> None:
                nonlocal last
                if last is None and earlier and not earlier["finished"]:
                    say(f"continuing the training after {earlier['steps']} steps")
                last = report
                show(
                    f"error {report.tracking_error:.3f} rad, {report.steps_per_second:.0f} steps/s, "
                    f"{report.seconds_left:.0f} s left",
                    done=report.batch,
                    total=report.batches,
                    line=report.batch % LINE_BATCHES == 0 or report.batch == report.batches,
                )
                if log is not None:
                    log(report)
                if view is not None:
                    view.show(lambda: Policy.load(run.path("policy")))
                interrupt_now()

            train_step(
                runs,
                seed=seed,
                batches=batches,
                env=env,
                preset=preset,
                resume=resume,
                device=device,
                on_round=show_round,
                on_batch=show_batch,
            )
        if last is None:
            say("the training is finished already")
    except KeyboardInterrupt:
        if last is None:
            say("interrupted before the first batch was done: no policy was written")
        else:
            say(f"interrupted at {last.batch} of {last.batches} batches, policy kept in {_places(runs)}")
        raise typer.Exit(130) from None


def _places(runs: "list[RunFolder]") -> str:
    return ", ".join(str(run.path("policy")) for run in runs)
