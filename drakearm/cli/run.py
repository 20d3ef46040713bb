"""`drakearm run`."""

from drakearm.cli.console import say
from drakearm.cli.evaluate import show_metrics
from drakearm.cli.folders import run_folder
from drakearm.cli.options import Batches, Env, Import, Out, Overwrite, PresetName, ScenarioArgument, Seed
from drakearm.cli.own_code import import_own_code
from drakearm.cli.train import train_run
from drakearm.experiments.choices import EnvKind


def run(
    scenario: ScenarioArgument,
    seed: Seed = 0,
    out: Out = None,
    batches: Batches = None,
    env: Env = EnvKind.compiled,
    preset: PresetName = None,
    overwrite: Overwrite = False,
    imports: Import = None,
) -> None:
    """Plan, train, evaluate and replay a scenario, and print a table of the results.

    If the run's folder already holds a plan of the same scenario, it is used, and only the other steps are done. A
    training that was stopped there is continued.
    """
    import_own_code(imports)
    from drakearm.experiments import evaluate_step, plan_step, replay_step

    with run_folder(scenario, out) as folder:
        if not overwrite and folder.holds_plan_of(scenario, preset):
            stopped = folder.path("training").exists() and not folder.path("replay").exists()
            folder.claim("train", overwrite=stopped)
            say(f"continuing with the plan in {folder.folder}")
        else:
            folder.claim("plan", overwrite)
            report = plan_step(folder, scenario, preset=preset)
            say(f"planned with {report.plan.solver} in {report.plan.seconds:.2f} s: {report.plan.status}")
            say(report.feasibility.verdict)
        train_run([folder], seed, batches, env, resume=not overwrite)
        metrics = evaluate_step(folder)
        replay = replay_step(folder)
        show_metrics(folder, metrics)
        say(f"open {replay} in a browser")
