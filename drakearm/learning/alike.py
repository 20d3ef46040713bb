"""Which tasks can share one compiled function."""

from collections.abc import Iterable, Sequence

import numpy as np

from drakearm.errors import TrainingError, shown
from drakearm.model import Arm, MakeTorqueArm
from drakearm.task import TrackingTask


def require_tasks(tasks: TrackingTask | Sequence[TrackingTask]) -> list[TrackingTask]:
    """One task or several, as a list. Raises TrainingError if there is anything else."""
    found = list(tasks) if isinstance(tasks, Iterable) and not isinstance(tasks, str) else [tasks]
    for task in found:
        if not isinstance(task, TrackingTask):
            raise TrainingError(
                f"Found the task {shown(task)}: expected a TrackingTask, which scenario_task makes from a scenario."
            )
    return found


def check_alike(tasks: list[TrackingTask], bodies: list[Arm]) -> tuple[np.ndarray, np.ndarray]:
    """The joint ranges, (n_q,) each, rad.

    Raises TrainingError, which names what differs, if the tasks cannot share one compiled function.
    """
    plants = {arm: MakeTorqueArm(arm) for arm in bodies}
    ranges = {
        arm: (list(plant.GetPositionLowerLimits()), list(plant.GetPositionUpperLimits()))
        for arm, plant in plants.items()
    }
    alike = [
        {
            "muscles": task.arm.muscles,
            "coordinates": task.arm.coordinates,
            "senses": task.senses,
            "lookahead": task.lookahead,
            "joint ranges": ranges[task.arm],
        }
        for task in tasks
    ]
    for i, other in enumerate(alike):
        different = [name for name in other if other[name] != alike[0][name]]
        if different:
            raise TrainingError(
                f"Task {i} differs from task 0 in its {' and '.join(different)}: "
                "expected the same in all tasks of one vector environment."
            )
    lower, upper = ranges[tasks[0].arm]
    return np.array(lower), np.array(upper)
