"""The steps of a run: plan, train, evaluate, replay. Each writes its files into the run folder."""

import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from drakearm.experiments.choices import EnvKind, Preset
from drakearm.experiments.environments import make_training_envs
from drakearm.experiments.metrics import run_policy, run_policy_stochastic, tracking_metrics, versions
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.scenario import Scenario, load_scenario
from drakearm.figures import write_plan_picture
from drakearm.learning import BatchReport, Policy, imitate, train
from drakearm.learning.policy import Actor
from drakearm.model import load_arm
from drakearm.model.recording import Recording
from drakearm.model.reference import Reference
from drakearm.planning import plan
from drakearm.planning.feasibility import muscle_feasibility
from drakearm.planning.plan_report import PlanReport
from drakearm.replay import write_replay
from drakearm.task import TrackingTask

# The files that each step writes, by their names in RunFolder.FILES
PLANNED = ("reference", "plan", "plan_picture")  # besides the scenario
TRAINED = ("policy", "training", "training_log")
EVALUATED = ("metrics", "recording")
REPLAYED = ("replay",)


def plan_step(
    run: RunFolder, scenario: str | Path, horizon: float | None = None, preset: Preset | None = None
) -> PlanReport:
    """Plans the optimal reference of a scenario and tests whether the muscles can follow it.

    Writes nothing if planning fails. horizon: s; if given, plans in a receding horizon (see `plan`). preset: replaces
    the preset of the scenario, for the later training.
    """
    loaded = load_scenario(scenario)
    arm = load_arm(loaded.arm)
    planned = plan(arm, loaded.movement, loaded.load_mass, loaded.obstacle, horizon)
    feasibility = muscle_feasibility(arm, planned.reference, loaded.load_mass)
    run.keep_scenario(scenario, preset)
    report = PlanReport(
        name=loaded.name,
        description=loaded.description,
        arm=arm,
        movement=loaded.movement,
        load_mass=loaded.load_mass,
        obstacle=loaded.obstacle,
        plan=planned,
        feasibility=feasibility,
    )
    planned.reference.save(run.path("reference"))
    run.write_json("plan", report.content)
    write_plan_picture(report, run.path("plan_picture"))
    return report


def train_step(
    run: RunFolder,
    *,
    seed: int,
    batches: int | None = None,
    env: EnvKind = EnvKind.compiled,
    on_round: Callable[[int, int], None] | None = None,
    on_batch: Callable[[BatchReport], None] | None = None,
) -> Policy:
    """Trains a policy whose excitations make the muscles follow the run's reference.

    batches: replaces the number in the scenario. on_round: called after each round of imitation with its number, from
    1, and the number of rounds. on_batch: called after each batch, when the current policy and training.json are
    already in the run folder. So a training that is interrupted can be evaluated too.
    """
    scenario = run.scenario()
    settings = scenario.training if batches is None else replace(scenario.training, batches=batches)
    task = _task(run, scenario)
    envs = make_training_envs(task, settings.environments, env)
    rounds = settings.imitation_rounds
    start = time.perf_counter()

    def prepare(actor: Actor) -> None:
        imitate(actor, [task], rounds, seed, lambda number: on_round(number, rounds) if on_round else None)

    def keep(report: BatchReport) -> None:
        """Writes the progress of the training."""
        progress = {"steps": report.steps, "seconds": time.perf_counter() - start}
        finished = report.batch == report.batches
        setup = {"seed": seed, "env": env.value, "finished": finished, "settings": asdict(settings)}
        run.write_json("training", setup | progress)
        if on_batch:
            on_batch(report)

    try:
        return train(
            envs,
            settings,
            seed=seed,
            metadata={"scenario": scenario.name, "seed": seed, "versions": versions()},
            prepare=prepare if rounds else None,
            log_path=run.path("training_log"),
            checkpoint_path=run.path("policy"),
            on_batch=keep,
        )
    finally:
        envs.close()


def evaluate_step(run: RunFolder) -> dict[str, Any]:
    """Runs the policy in closed loop on the Diagram. Writes metrics.json and returns its content."""
    policy = Policy.load(run.existing("policy", "train"))
    training = run.read_json("training", "train")
    planned = run.read_json("plan", "plan")
    scenario = run.scenario()
    task = _task(run, scenario)
    recording = run_policy(task, policy)
    recording.save(run.path("recording"))
    metrics = {
        "scenario": scenario.name,
        **tracking_metrics(recording, run_policy_stochastic(task, policy, training["seed"])),
        "training_steps": training["steps"],
        "training_seconds": training["seconds"],
        "plan_seconds": planned["seconds"],
        "seed": training["seed"],
        "versions": versions(),
    }
    run.write_json("metrics", metrics)
    return metrics


def replay_step(run: RunFolder) -> Path:
    """Writes the browser replay of the deterministic run. Returns its file."""
    scenario = run.scenario()
    recording = Recording.load(run.existing("recording", "evaluate"))
    write_replay(
        run.path("replay"),
        load_arm(scenario.arm),
        recording,
        load_mass=scenario.load_mass,
        obstacle=scenario.obstacle,
        title=scenario.name,
    )
    return run.path("replay")


def _task(run: RunFolder, scenario: Scenario) -> TrackingTask:
    return scenario.task(Reference.load(run.existing("reference", "plan")))
