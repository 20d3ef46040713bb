"""`drakearm replay`."""

from drakearm.cli.console import say
from drakearm.cli.folders import learned_run_folder
from drakearm.cli.options import Import, Out, Overwrite, ScenarioArgument
from drakearm.cli.own_code import import_own_code


def replay(scenario: ScenarioArgument, out: Out = None, overwrite: Overwrite = False, imports: Import = None) -> None:
    """Show the movement in a browser, in slow motion.

    Writes replay.html: one file that any browser opens, without a connection to the internet. It shows the recording
    of `drakearm evaluate`, with the plan as a translucent arm. Without a run of the scenario, it shows the policy that
    drakearm ships for it: `drakearm replay reach-045`.
    """
    import_own_code(imports)
    from drakearm.experiments import evaluate_step, replay_step

    with learned_run_folder(scenario, out) as run:
        if not run.path("recording").exists():
            evaluate_step(run)
        run.claim("replay", overwrite)
        say(f"open {replay_step(run)} in a browser")
