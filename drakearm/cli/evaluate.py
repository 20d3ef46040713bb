"""`drakearm evaluate`."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drakearm.cli.console import console, say
from drakearm.cli.folders import (
    learned_run_folder,
    newly_planned_run_folder,
    opened,
    planned_run_folder,
    say_removed,
)
from drakearm.cli.options import Import, OutOfAll, Overwrite, ScenarioArguments, path
from drakearm.cli.own_code import import_own_code
from drakearm.cli.perturbations import (
    Load,
    MotorNoise,
    Push,
    SensorDelay,
    StartOffset,
    Strength,
    chosen_perturbations,
)
from drakearm.cli.progress import show_progress

if TYPE_CHECKING:
    from drakearm.diagrams import Perturbation
    from drakearm.experiments import RunFolder


def evaluate(
    scenarios: ScenarioArguments,
    policy: Annotated[
        Path | None,
        typer.Option(
            help="Evaluate this policy instead of the run's own, or `static` for static optimization.",
            metavar="FILE",
            parser=path,
        ),
    ] = None,
    load: Load = None,
    motor_noise: MotorNoise = None,
    sensor_delay: SensorDelay = None,
    push: Push = None,
    strength: Strength = None,
    start_offset: StartOffset = None,
    out: OutOfAll = None,
    overwrite: Overwrite = False,
    imports: Import = None,
) -> None:
    """Measure how well the policy follows the plan, on the Drake Diagram.

    Without a run of the scenario, the policy that drakearm ships for it is measured: `drakearm evaluate reach-045`.

    Runs the policy once without noise and 10 times with noise. Writes metrics.json (errors in rad) and recording.npz
    (angles, activations and forces of the run without noise), and prints a table.

    With several scenarios, each is evaluated in its own run, and one table shows the errors of all:
    `drakearm evaluate reach-000 reach-090`.

    With another policy, or with perturbations, of which no policy knows: 10 runs without exploration, each from a
    random start. The results go to perturbed.json and perturbed.npz (the first of the runs), and the run's own metrics
    stay. Several perturbations act together.

    `drakearm evaluate lift-2kg --policy static --out runs/static` needs no training: static optimization moves the arm.
    It writes metrics.json and recording.npz, into a folder without a policy. If there is no plan, it plans first.
    """
    import_own_code(imports)
    perturbations = chosen_perturbations(load, motor_noise, sensor_delay, push, strength, start_offset)
    from drakearm.experiments import evaluate_step, static_step
    from drakearm.repertoire.driver import STATIC

    static = str(policy) == STATIC
    if static and perturbations:
        raise typer.BadParameter("expected a policy with perturbations, not static optimization.")
    open_one = newly_planned_run_folder if static else planned_run_folder if policy else learned_run_folder
    measure = static_step if static else evaluate_step
    with opened(open_one, scenarios, out) as runs:
        step = "perturb" if perturbations or (policy and not static) else "evaluate"
        outdated = [file for run in runs for file in run.claim(step, overwrite)]
        if step == "perturb":
            for run in runs:
                _evaluate_perturbed(run, perturbations, policy)
        elif len(runs) == 1:
            show_metrics(runs[0], measure(runs[0]))
        else:
            _evaluate_several(runs, measure)
        say_removed(outdated)


def _evaluate_several(runs: "list[RunFolder]", measure: "Callable[[RunFolder], dict[str, Any]]") -> None:
    from drakearm.figures import evaluations_table

    evaluations: list[dict[str, Any]] = []
    with show_progress("evaluating", transient=True) as show:
        for run in runs:
            show(run.scenario().name, done=len(evaluations), total=len(runs))
            evaluations.append(measure(run))
    console.print(evaluations_table(evaluations))
    say(f"files in {', '.join(str(run.folder) for run in runs)}")


def _evaluate_perturbed(run: "RunFolder", perturbations: "list[Perturbation]", policy: Path | None) -> None:
    from drakearm.experiments import perturb_step
    from drakearm.figures import perturbed_table

    metrics = perturb_step(run, perturbations, policy)
    console.print(perturbed_table(metrics, run.scenario().loaded_arm.coordinates))
    say(f"results in {run.path('perturbed')}")


def show_metrics(run: "RunFolder", metrics: dict[str, Any]) -> None:
    """Prints how the plan, the training and the evaluation of a run went."""
    from drakearm.figures import metrics_table

    console.print(metrics_table(metrics, run.read_json("plan", "plan")))
    say(f"files in {run.folder}")
