"""One policy for the movements of several runs: whether they fit together, and how a training's record names them."""

from collections.abc import Sequence
from dataclasses import asdict, replace

from gymnasium.vector import VectorEnv

from drakearm.errors import TrainingError
from drakearm.experiments.choices import EnvKind
from drakearm.experiments.environments import make_training_envs
from drakearm.experiments.provenance import fingerprint
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.scenario import Scenario
from drakearm.learning import ArmVectorEnv, PpoSettings
from drakearm.model.loader import arm_folder
from drakearm.task import TrackingTask, check_interchangeable


def shared_tasks(runs: Sequence[RunFolder], scenarios: Sequence[Scenario]) -> list[TrackingTask]:
    """The tasks of runs that one policy learns. Each run may have its own copy of the same arm.

    Raises TaskError, with the names of two scenarios and what differs, unless arm, senses and reward are the same.
    """
    tasks = [run.task(scenario) for run, scenario in zip(runs, scenarios, strict=True)]
    arms = [fingerprint(arm_folder(scenario.arm)) for scenario in scenarios]
    tasks = [replace(task, arm=tasks[arms.index(arm)].arm) for task, arm in zip(tasks, arms, strict=True)]
    check_interchangeable(tasks, [scenario.name for scenario in scenarios])
    return tasks


def shared_settings(scenarios: Sequence[Scenario], settings: Sequence[PpoSettings]) -> PpoSettings:
    """The settings that all scenarios have. Raises TrainingError, with what differs in which two, if they differ."""
    first = asdict(settings[0])
    for scenario, other in zip(scenarios, settings, strict=True):
        different = [name for name, value in asdict(other).items() if value != first[name]]
        if different:
            raise TrainingError(
                f"{scenario.name} differs from {scenarios[0].name} in its training settings ({', '.join(different)}): "
                "expected the same in all scenarios of one policy."
            )
    return settings[0]


def shared_envs(tasks: Sequence[TrackingTask], count: int, kind: EnvKind) -> VectorEnv:
    """`count` arms, to which the tasks are assigned round-robin. Raises TrainingError if there are more tasks."""
    if len(tasks) == 1:
        return make_training_envs(tasks[0], count, kind)
    if kind is not EnvKind.compiled:
        raise TrainingError(f"One policy learns several scenarios on compiled arms only: found {kind.value}.")
    return ArmVectorEnv(tasks, count)


def record_of(runs: Sequence[RunFolder]) -> list[dict[str, str]]:
    """The name of each scenario and the fingerprint of its plan, in the order of the tasks."""
    return [{"name": run.scenario().name, "reference": fingerprint(run.path("reference"))} for run in runs]
