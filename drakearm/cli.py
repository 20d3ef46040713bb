"""The command `drakearm`: from a scenario's name to a plan, a policy, its metrics and a replay in the browser."""

import logging
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from rich.table import Table

from drakearm.errors import DrakearmError, RunFolderError
from drakearm.experiments.arm_picture import check_picture_path, write_picture
from drakearm.experiments.arm_table import muscle_table
from drakearm.experiments.environments import EnvKind
from drakearm.experiments.plan_report import PlanReport
from drakearm.experiments.plan_table import fact_table, plans_table
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.scenario import Preset, load_scenario, scenario_files
from drakearm.experiments.steps import PLANNED, evaluate_step, plan_step, replay_step, train_step
from drakearm.learning import BatchReport
from drakearm.model import load_arm
from drakearm.model.inspection import inspect_arm

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    help="""A human arm with 14 Hill-type muscles in Drake.

    A run has four steps: **plan** finds the optimal joint movement, **train** learns muscle excitations that follow it,
    **evaluate** measures how well, **replay** shows it in a browser. `drakearm run SCENARIO` does the four in a row.

    Start with `drakearm list`, then `drakearm run timing-0.7s`.
    """,
)
console = Console()

ScenarioArgument = Annotated[
    str, typer.Argument(help="A name from `drakearm list`, or the path of a scenario file.", metavar="SCENARIO")
]
Out = Annotated[
    Path | None, typer.Option("--out", help="Folder of the run. [default: runs/SCENARIO]", show_default=False)
]
Seed = Annotated[int, typer.Option(help="Decides every random number: the same seed gives the same result.")]
Batches = Annotated[
    int | None,
    typer.Option(min=1, help="Train for so many batches, instead of the scenario's number.", show_default=False),
]
Env = Annotated[EnvKind, typer.Option(help="Train on the compiled arm, or on Drake Diagrams: slower, same arm.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace the results of an earlier run.")]


@app.command("list")
def list_scenarios() -> None:
    """Show the movements that drakearm ships."""
    table = Table("scenario", "what moves")
    for name in scenario_files():
        table.add_row(name, load_scenario(name).description)
    console.print(table)


@app.command()
def inspect(
    arm: Annotated[str, typer.Argument(help="arm14, or the folder of an arm of your own.", metavar="ARM")],
    out: Annotated[
        Path | None, typer.Option("--out", help="The picture, a .png. [default: ARM.png]", show_default=False)
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an earlier picture.")] = False,
) -> None:
    """Look at an arm's muscles: a table of their numbers, and a picture of lengths, moment arms and curves."""
    loaded = load_arm(arm)
    file = out or Path(f"{loaded.name}.png")
    check_picture_path(file, overwrite)
    inspection = inspect_arm(loaded)
    write_picture(inspection, file)
    console.print(muscle_table(inspection))
    console.print(f"open {file} for lengths, moment arms and curves")


@app.command()
def plan(
    scenarios: Annotated[
        list[str],
        typer.Argument(
            help="Names from `drakearm list`, paths of scenario files, or `all` that drakearm ships.",
            metavar="SCENARIO...",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", help="Folder of the run; of all runs, if there are several. [default: runs]", show_default=False
        ),
    ] = None,
    horizon: Annotated[
        float | None,
        typer.Option(
            help="Plan anew every 40 ms, so many seconds ahead, as the paper does (it has 1.6).", show_default=False
        ),
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Find the optimal reference with direct collocation; writes scenario.yaml, reference.npz, plan.json and plan.png.

    One scenario: prints the facts about its plan. Several: goes on where one has no plan, and prints a table.
    """
    names = list(
        dict.fromkeys(name for given in scenarios for name in (scenario_files() if given == "all" else [given]))
    )
    if len(names) == 1:
        run = _run_folder(names[0], out)
        run.claim(PLANNED, overwrite)
        console.print(fact_table(plan_step(run, names[0], horizon)))
        console.print(f"open {run.path('plan_picture')} for the movement and its limits")
        return
    results = _plan_several(names, out or Path("runs"), overwrite, horizon)
    console.print(plans_table(results))
    console.print(f"open {out or 'runs'}/SCENARIO/{RunFolder.FILES['plan_picture']} for a movement and its limits")
    if any(isinstance(result, DrakearmError) for result in results.values()):
        raise typer.Exit(1)


@app.command()
def train(
    scenario: ScenarioArgument,
    seed: Seed = 0,
    out: Out = None,
    batches: Batches = None,
    env: Env = EnvKind.compiled,
    overwrite: Overwrite = False,
) -> None:
    """Learn muscle excitations that follow a plan; writes policy.safetensors, training.csv and training.json.

    Needs the plan in the run's folder. A training that is interrupted leaves its latest checkpoint as the policy.
    """
    run = _begun_run(scenario, out)
    run.claim(("policy", "training", "training_log"), overwrite)
    _train(run, seed, batches, env)


@app.command()
def evaluate(scenario: ScenarioArgument, out: Out = None, overwrite: Overwrite = False) -> None:
    """Run the policy in closed loop, once without and 10 times with noise; writes metrics.json and recording.npz."""
    run = _begun_run(scenario, out)
    run.existing("policy", f"train {scenario}")
    run.claim(("metrics", "recording"), overwrite)
    metrics = evaluate_step(run)
    console.print(_table(run, metrics))


@app.command()
def replay(scenario: ScenarioArgument, out: Out = None, overwrite: Overwrite = False) -> None:
    """Write the movement as one HTML file that any browser opens; writes replay.html."""
    run = _begun_run(scenario, out)
    run.existing("recording", f"evaluate {scenario}")
    run.claim(("replay",), overwrite)
    console.print(f"open {replay_step(run)} in a browser")


@app.command("run")
def run_all(
    scenario: ScenarioArgument,
    seed: Seed = 0,
    out: Out = None,
    batches: Batches = None,
    env: Env = EnvKind.compiled,
    preset: Annotated[
        Preset | None,
        typer.Option(
            help="`paper` learns as the paper does: 28 observations, from random weights. [default: the scenario's]",
            show_default=False,
        ),
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Plan, train, evaluate and replay a scenario, and print a table of how it went."""
    run = _run_folder(scenario, out)
    run.claim(tuple(RunFolder.FILES), overwrite)
    _plan(run, scenario, preset)
    _train(run, seed, batches, env)
    metrics = evaluate_step(run)
    replay_step(run)
    console.print(_table(run, metrics))


def _run_folder(scenario: str, out: Path | None) -> RunFolder:
    return RunFolder(out or Path("runs") / load_scenario(scenario).name)


def _begun_run(scenario: str, out: Path | None) -> RunFolder:
    """The folder of a run that has a plan. Raises RunFolderError where it has none, or one of another scenario."""
    run = _run_folder(scenario, out)
    run.existing("reference", f"plan {scenario}")
    wanted, found = load_scenario(scenario).name, run.scenario().name
    if wanted != found:
        raise RunFolderError(f"{run.folder} holds a run of {found}: expected {wanted}.")
    return run


def _plan(run: RunFolder, scenario: str, preset: Preset | None) -> None:
    report = plan_step(run, scenario, preset=preset)
    planned = report.plan
    console.print(f"planned with {planned.solver} in {planned.seconds:.2f} s: {planned.status}")
    console.print(report.feasibility.verdict)


def _plan_several(
    scenarios: list[str], out: Path, overwrite: bool, horizon: float | None
) -> dict[str, PlanReport | DrakearmError]:
    """Plans each scenario into a folder of its name, and keeps the errors of those that cannot be planned."""
    runs: dict[str, tuple[str, RunFolder]] = {}
    for scenario in scenarios:
        name = load_scenario(scenario).name
        if name in runs:
            raise RunFolderError(f"{runs[name][0]} and {scenario} are both named {name}: expected a folder for each.")
        runs[name] = (scenario, RunFolder(out / name))
    for _, run in runs.values():
        run.claim(PLANNED, overwrite)
    results: dict[str, PlanReport | DrakearmError] = {}
    columns = (TextColumn("planning"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[name]}"))
    with Progress(*columns, console=console, transient=True) as progress:
        bar = progress.add_task("planning", total=len(runs), name="")
        for name, (scenario, run) in runs.items():
            progress.update(bar, name=name)
            try:
                results[name] = plan_step(run, scenario, horizon)
            except DrakearmError as error:
                results[name] = error
            progress.advance(bar)
    return results


def _train(run: RunFolder, seed: int, batches: int | None, env: EnvKind) -> None:
    columns = (
        TextColumn("training"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[report]}"),
    )
    with Progress(*columns, console=console) as progress:
        bar = progress.add_task("training", total=None, report="")

        def imitating(number: int, rounds: int) -> None:
            progress.update(bar, report=f"imitated static optimization, {number} of {rounds} rounds")

        def show(report: BatchReport) -> None:
            text = (
                f"error {report.tracking_error:.3f} rad, {report.steps_per_second:.0f} steps/s, "
                f"{report.seconds_left:.0f} s left"
            )
            progress.update(bar, total=report.batches, completed=report.batch, report=text)

        train_step(run, seed=seed, batches=batches, env=env, on_round=imitating, on_batch=show)


def _table(run: RunFolder, metrics: dict[str, Any]) -> Table:
    planned = run.read_json("plan", "plan")
    joints = load_arm(run.scenario().arm).coordinates

    def per_joint(values: list[float]) -> str:
        return ", ".join(f"{joint} {value:.4f}" for joint, value in zip(joints, values, strict=True))

    table = Table(title=f"{metrics['scenario']}, seed {metrics['seed']}", show_header=False)
    rate = metrics["training_steps"] / metrics["training_seconds"]
    for row in (
        ("plan", f"{planned['solver']}: {planned['status']}, {planned['seconds']:.2f} s"),
        ("training", f"{metrics['training_steps']} steps, {rate:.0f} steps/s, {metrics['training_seconds']:.0f} s"),
        ("mean error (rad)", per_joint(metrics["tracking_error_mean"])),
        ("largest error (rad)", per_joint(metrics["tracking_error_max"])),
        ("end error (rad)", per_joint(metrics["end_error"])),
        ("noisy runs that succeed", f"{metrics['success_rate']:.0%}"),
        ("files", str(run.folder)),
        ("replay", str(run.path("replay"))),
    ):
        table.add_row(*row)
    return table


def main() -> None:
    """Entry point: errors that a user can cause are one sentence on stderr and exit code 1."""
    logging.getLogger("drake").setLevel(logging.WARNING)  # Meshcat announces itself when a replay is written
    try:
        app()
    except DrakearmError as error:
        Console(stderr=True).print(f"[red]error:[/red] {error}", highlight=False, soft_wrap=True)
        sys.exit(1)
