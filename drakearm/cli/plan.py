"""`drakearm plan`."""

from contextlib import ExitStack
from typing import TYPE_CHECKING, Annotated

import typer

from drakearm.cli.console import console, say
from drakearm.cli.folders import folders_of, run_folder, say_removed
from drakearm.cli.options import Import, OutOfAll, Overwrite, duration, scenarios_argument
from drakearm.cli.own_code import import_own_code
from drakearm.cli.progress import show_progress
from drakearm.errors import DrakearmError

if TYPE_CHECKING:
    from drakearm.experiments import RunFolder
    from drakearm.planning.plan_report import PlanReport


def plan(
    scenarios: Annotated[
        list[str],
        scenarios_argument("Names from `drakearm list`, paths of scenario files, or `all` for all shipped scenarios."),
    ],
    out: OutOfAll = None,
    horizon: Annotated[
        float | None,
        typer.Option(
            help="Plan again every 40 ms, and only this many seconds ahead, as the paper does (it uses 1.6).",
            metavar="SECONDS",
            parser=duration,
            show_default=False,
        ),
    ] = None,
    overwrite: Overwrite = False,
    imports: Import = None,
) -> None:
    """Find the optimal joint movement with direct collocation.

    Writes scenario.yaml, reference.npz (the movement), plan.json (costs, margins, whether the muscles can do it) and
    plan.png into the run's folder.

    `drakearm plan obstacle` prints the facts about one plan. `drakearm plan all` plans all shipped scenarios and prints
    a table; if some have no plan, it says why and plans the others.

    `drakearm plan mine.yaml --import my_costs` plans with costs that you define in my_costs.py.
    """
    import_own_code(imports)
    from drakearm.experiments import RunFolder, plan_step, scenario_files
    from drakearm.figures import plan_facts, plans_table

    several = [name for given in scenarios for name in (scenario_files() if given == "all" else [given])]
    several = list(dict.fromkeys(several))  # each once
    if len(several) == 1:
        with run_folder(several[0], out) as run:
            outdated = run.claim("plan", overwrite)
            console.print(plan_facts(plan_step(run, several[0], horizon)))
            say_removed(outdated)
            say(f"open {run.path('plan_picture')} for the movement and its limits")
        return
    runs = folders_of(several, out)
    with ExitStack() as locks:
        for run, _ in runs.values():
            locks.enter_context(run.locked())
            run.claim("plan", overwrite)
        results = _plan_several(runs, horizon)
    console.print(plans_table(results))
    say(f"open {out or 'runs'}/SCENARIO/{RunFolder.FILES['plan_picture']} for a movement and its limits")
    if any(isinstance(result, DrakearmError) for result in results.values()):
        raise typer.Exit(1)


def _plan_several(
    runs: "dict[str, tuple[RunFolder, str]]", horizon: float | None
) -> "dict[str, PlanReport | DrakearmError]":
    """Plans each scenario into its folder, and keeps the errors of those that cannot be planned."""
    from drakearm.experiments import plan_step

    results: dict[str, PlanReport | DrakearmError] = {}
    with show_progress("planning", transient=True) as show:
        for number, (name, (run, scenario)) in enumerate(runs.items()):
            show(name, done=number, total=len(runs), line=False)
            try:
                results[name] = report = plan_step(run, scenario, horizon)
                how = f"{report.plan.status}, {report.plan.seconds:.2f} s"
            except DrakearmError as error:
                results[name] = error
                how = "no plan"
            show(f"{name}, {how}", done=number + 1, total=len(runs))
    return results
