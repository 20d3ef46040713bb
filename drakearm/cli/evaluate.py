"""`drakearm evaluate`."""

from typing import TYPE_CHECKING, Any

from drakearm.cli.console import console, say
from drakearm.cli.folders import planned_run_folder, say_removed
from drakearm.cli.options import Import, Out, Overwrite, ScenarioArgument
from drakearm.cli.own_code import import_own_code

if TYPE_CHECKING:
    from drakearm.experiments import RunFolder


def evaluate(scenario: ScenarioArgument, out: Out = None, overwrite: Overwrite = False, imports: Import = None) -> None:
    """Measure how well the policy follows the plan, on the Drake Diagram.

    Runs the policy once without noise and 10 times with noise. Writes metrics.json (errors in rad) and recording.npz
    (angles, activations and forces of the run without noise), and prints a table.
    """
    import_own_code(imports)
    from drakearm.experiments import evaluate_step

    with planned_run_folder(scenario, out) as run:
        run.existing("policy", f"train {scenario}")
        outdated = run.claim("evaluate", overwrite)
        show_metrics(run, evaluate_step(run))
        say_removed(outdated)


def show_metrics(run: "RunFolder", metrics: dict[str, Any]) -> None:
    """Prints how the plan, the training and the evaluation of a run went."""
    from drakearm.figures import metrics_table

    console.print(metrics_table(metrics, run.read_json("plan", "plan")))
    say(f"files in {run.folder}")
