"""The steps of a run: plan, train, evaluate, replay. Each writes its files into the run folder."""

import json
import shutil
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from drakearm.errors import RunFolderError, TrainingError, shown
from drakearm.experiments.captions import caption
from drakearm.experiments.choices import EnvKind, Preset
from drakearm.experiments.environments import make_training_envs
from drakearm.experiments.metrics import evaluation_metrics, run_policy, run_policy_stochastic, versions
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.scenario import load_scenario
from drakearm.experiments.sharing import record_of, shared_settings, shared_tasks
from drakearm.figures import Movement, write_movement_picture, write_plan_picture
from drakearm.learning import BatchReport, Policy, PpoSettings, prepare, train
from drakearm.model.loader import arm_folder
from drakearm.model.recording import Recording, save_recordings
from drakearm.planning import plan
from drakearm.planning.feasibility import muscle_feasibility
from drakearm.planning.plan_report import PlanReport
from drakearm.replay import write_replay
from drakearm.task import TrackingTask


def plan_step(
    run: RunFolder, scenario: str | Path, horizon: float | None = None, preset: Preset | None = None
) -> PlanReport:
    """Plans the optimal reference of a scenario and tests whether the muscles can follow it.

    If planning fails, the folder stays as it was. If not, the files of an earlier plan are replaced, and what was made
    from it is removed. horizon: s; if given, plans in a receding horizon (see `plan`). preset: replaces
    the preset of the scenario, for the later training.
    """
    loaded = load_scenario(scenario)
    arm = loaded.loaded_arm
    planned = plan(arm, loaded.movement, loaded.load_mass, loaded.obstacle, horizon)
    feasibility = muscle_feasibility(arm, planned.reference, loaded.load_mass)
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
    with run.replacing("plan", arm_folder(loaded.arm)) as new:
        new.keep_scenario(scenario, preset)
        planned.reference.save(new.path("reference"))
        write_plan_picture(report, new.path("plan_picture"))
        new.write_record(report.content)
    return report


def train_step(
    run: RunFolder | Sequence[RunFolder],
    *,
    seed: int,
    batches: int | None = None,
    env: EnvKind = EnvKind.compiled,
    preset: Preset | None = None,
    resume: bool = False,
    device: str | None = None,
    on_round: Callable[[int, int], None] | None = None,
    on_batch: Callable[[BatchReport], None] | None = None,
) -> Policy:
    """Trains a policy whose excitations make the muscles follow the run's reference.

    If there are several runs, one policy learns to follow all of their references, and each run gets it. The same runs
    in the same order, with the same seed, give the same policy. Raises TaskError or TrainingError, with the names of
    two scenarios, if they differ in arm, senses, reward or training settings.

    batches: replaces the number in the scenario. preset: replaces the one in the run's scenario. resume: whether to
    continue a training that was stopped, which then ends with the same policy as if it had not been. If there is none,
    the training begins; if it is finished, its policy is returned. Raises RunFolderError if it had another preset or
    seed, other settings or environments. device: of PyTorch, see `train`. on_round: called after each round of
    imitation with its number, from 1, and the number of rounds. on_batch: called after each batch, when the current
    policy and training.json are already in the run folder. So a training that is interrupted can be evaluated too.
    Until the first batch is done, the files of an earlier training stay.
    """
    runs = [run] if isinstance(run, RunFolder) else list(run)
    if not runs:
        raise TrainingError("There is no run to train in: expected at least one.")
    first = runs[0]
    with ExitStack() as stack:
        for each in runs:
            stack.enter_context(each.locked())
        work = stack.enter_context(first.scratch())
        scenarios = [each.scenario(preset) for each in runs]
        tasks = shared_tasks(runs, scenarios)
        settings = shared_settings(scenarios, [with_batches(each.training, batches) for each in scenarios])
        setup = {
            "preset": scenarios[0].preset.value,
            "scenarios": record_of(runs),
            "seed": seed,
            "env": env.value,
            "settings": asdict(settings),
        }
        found = [_earlier_training(each, setup) if resume else None for each in runs]
        if all(training and training["finished"] for training in found):
            return Policy.load(first.existing("policy", "train"))
        earlier = found[0] if found[0] and not found[0]["finished"] else None
        if earlier:
            shutil.copy(first.existing("checkpoint", "train --overwrite"), work)
            shutil.copy(first.existing("training_log", "train --overwrite"), work)
        start = time.perf_counter() - (earlier["seconds"] if earlier else 0.0)

        def show_round(number: int) -> None:
            if on_round:
                on_round(number, settings.imitation_rounds)

        def keep(report: BatchReport) -> None:
            """Puts the policy, the log and the progress of the training into each run folder, all together.

            Only the first run has the checkpoint. It is the last to be written: so the others are never behind it.
            """
            progress = {"steps": report.steps, "seconds": time.perf_counter() - start}
            finished = report.batch == report.batches
            for each, scenario in reversed(list(zip(runs, scenarios, strict=True))):
                with each.replacing("train", arm_folder(scenario.arm)) as new:
                    if preset:
                        new.keep_preset(preset)
                    for name in ("policy", "training_log", *(["checkpoint"] if each is first and not finished else [])):
                        shutil.copyfile(work / new.path(name).name, new.path(name))
                    new.write_record(setup | {"finished": finished} | progress)
            if on_batch:
                on_batch(report)

        envs = make_training_envs(tasks, settings.environments, env)
        try:
            return train(
                envs,
                settings,
                seed=seed,
                metadata={
                    "scenario": ", ".join(scenario.name for scenario in scenarios),
                    "seed": seed,
                    "versions": versions(),
                },
                prepare=lambda actor: prepare(actor, tasks, settings, seed, show_round),
                device=device,
                log_path=work / first.path("training_log").name,
                checkpoint_path=work / first.path("policy").name,
                resume_path=work / first.path("checkpoint").name,
                on_batch=keep,
            )
        finally:
            envs.close()


def evaluate_step(run: RunFolder) -> dict[str, Any]:
    """Runs the policy in closed loop on the Diagram. Writes recordings, movement.png and metrics.json.

    Returns the content of metrics.json.
    """
    with run.locked():
        policy = Policy.load(run.existing("policy", "train"))
        training = run.read_json("training", "train")
        planned = run.read_json("plan", "plan")
        scenario = run.scenario()
        task = run.task(scenario)
        start = time.perf_counter()
        recording, noisy = run_policy(task, policy), run_policy_stochastic(task, policy, training["seed"])
        metrics = {
            "scenario": scenario.name,
            "seed": training["seed"],
            **evaluation_metrics(task, recording, noisy, scenario.success),
            "training_steps": training["steps"],
            "training_seconds": training["seconds"],
            "plan_seconds": planned["seconds"],
            "evaluation_seconds": time.perf_counter() - start,
            "versions": versions(),
        }
        write_evaluation(run, task, recording, noisy, metrics)
        return metrics


def write_evaluation(
    run: RunFolder, task: TrackingTask, recording: Recording, noisy: Sequence[Recording], metrics: dict[str, Any]
) -> None:
    """Writes the files of an evaluation: of the run without noise, of those with noise, and their metrics."""
    scenario = run.scenario()
    with run.replacing("evaluate", arm_folder(scenario.arm)) as new:
        recording.save(new.path("recording"))
        save_recordings(noisy, new.path("noisy"))
        movement = Movement(task, recording, noisy, metrics, scenario.name, scenario.description)
        write_movement_picture(movement, new.path("movement_picture"))
        new.write_record(metrics)


def replay_step(run: RunFolder) -> Path:
    """Writes the browser replay of the deterministic run. Returns its file."""
    with run.locked():
        scenario = run.scenario()
        recording = Recording.load(run.existing("recording", "evaluate"))
        metrics, plan = run.read_json("metrics", "evaluate"), run.read_json("plan", "plan")
        weakness = "" if plan["feasibility"]["feasible"] else plan["feasibility"]["verdict"]
        with run.replacing("replay", arm_folder(scenario.arm)) as new:
            write_replay(
                new.path("replay"),
                scenario.loaded_arm,
                recording,
                load_mass=scenario.load_mass,
                obstacle=scenario.obstacle,
                caption=caption(scenario.name, scenario.description, metrics["noise_free"], weakness),
            )
            with new.path("replay").open("a", encoding="utf-8") as page:
                page.write(f"\n<!-- made from {json.dumps(new.made_from())} -->\n")
        return run.path("replay")


def with_batches(settings: PpoSettings, batches: int | None) -> PpoSettings:
    """The settings with another number of batches, if one is given. Raises TrainingError if it is impossible."""
    try:
        return settings if batches is None else replace(settings, batches=batches)
    except ValidationError as error:
        raise TrainingError(
            f"The training cannot have {shown(batches)} batches: {error.errors()[0]['msg']}."
        ) from error


def _earlier_training(run: RunFolder, setup: dict[str, Any]) -> dict[str, Any] | None:
    """training.json of the training in a run folder, if there is one. Raises RunFolderError if it had another setup."""
    if not run.path("training").exists():
        return None
    run.existing("policy", "train")
    older = {"preset": run.scenario().preset.value, "scenarios": record_of([run])}  # what older records do not say
    training = older | run.read_json("training", "train")
    for name, value in json.loads(json.dumps(setup)).items():
        if training[name] != value:
            names = ", ".join(scenario["name"] for scenario in training["scenarios"])
            other = f"list of plans ({names})" if name == "scenarios" else name
            raise RunFolderError(
                f"{shown(run.folder)} holds a training with another {other}, so it cannot be continued: "
                "expected the same, or --overwrite."
            )
    return training
