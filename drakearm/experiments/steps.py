"""The steps of a run: plan, train, evaluate, replay. Each writes its files into the run folder."""

import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from drakearm.experiments.environments import EnvKind, make_training_envs
from drakearm.experiments.metrics import (
    run_policy,
    run_policy_stochastic,
    tracking_metrics,
    versions,
)
from drakearm.experiments.plan_picture import write_plan_picture
from drakearm.experiments.plan_report import PlanReport
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.scenario import Preset, Scenario, load_scenario
from drakearm.learning import BatchReport, Policy, imitate, train
from drakearm.learning.policy import Actor
from drakearm.model import load_arm
from drakearm.model.recording import Recording
from drakearm.model.reference import Reference
from drakearm.planning import plan
from drakearm.planning.feasibility import muscle_feasibility
from drakearm.replay import write_replay
from drakearm.task import TrackingTask

PLANNED = ("reference", "plan", "plan_picture")  # what `plan_step` writes, beside the scenario


def plan_step(
    run: RunFolder, scenario: str | Path, horizon: float | None = None, preset: Preset | None = None
) -> PlanReport:
    """Finds the optimal reference of a scenario, and whether the muscles can do it. Writes nothing where it fails.

    horizon: s, plans in a receding horizon (see `plan`). preset: in place of the scenario's, for the training to come.
    """
    loaded = load_scenario(scenario)
    arm = load_arm(loaded.arm)
    planned = plan(arm, loaded.movement, loaded.load_mass, loaded.obstacle, horizon)
    feasibility = muscle_feasibility(arm, planned.reference, loaded.load_mass)
    report = PlanReport(run.keep_scenario(scenario, preset), arm, planned, feasibility)
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
    """Learns the excitations that follow the run's reference. batches: in place of the scenario's number.

    on_round: called with the number of each round of imitation, from 1, and how many there are.
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
        """Notes how far the training got, so that an interrupted one can be evaluated too."""
        progress = {"steps": report.steps, "seconds": time.perf_counter() - start}
        finished = report.batch == report.batches
        about = {"seed": seed, "env": env.value, "finished": finished, "settings": asdict(settings)}
        run.write_json("training", about | progress)
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
    """Runs the policy in closed loop on the Diagram; returns what it writes into metrics.json."""
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
    """Writes the browser replay of the deterministic run and returns its file."""
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
