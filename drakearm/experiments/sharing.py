"""One policy for the movements of several runs: whether they fit together, and how a training's record names them."""

from collections.abc import Sequence
from dataclasses import asdict, replace

from drakearm.errors import TrainingError
from drakearm.experiments.provenance import fingerprint
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.scenario import Scenario
from drakearm.learning import PpoSettings
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


def record_of(runs: Sequence[RunFolder]) -> list[dict[str, str]]:
    """The name of each scenario and the fingerprint of its plan, in the order of the tasks."""
    return [{"name": run.scenario().name, "reference": fingerprint(run.path("reference"))} for run in runs]
