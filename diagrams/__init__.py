"""Functions that build Diagrams out of Drake's systems and drakearm's."""

from drakearm.diagrams.muscle_arm import AddMuscleArm, MakeSimulator, MuscleArm
from drakearm.diagrams.policy_loop import MakePolicyLoop, PolicyLoop
from drakearm.diagrams.static_loop import MakeStaticLoop
from drakearm.diagrams.torque_arm import MakeTorqueArm
from drakearm.diagrams.tracking_task import (
    AddTrackingTask,
    MakeTrackingTask,
    TaskSystems,
    TrackingTask,
)

__all__ = [
    "AddMuscleArm",
    "AddTrackingTask",
    "MakePolicyLoop",
    "MakeSimulator",
    "MakeStaticLoop",
    "MakeTorqueArm",
    "MakeTrackingTask",
    "MuscleArm",
    "PolicyLoop",
    "TaskSystems",
    "TrackingTask",
]
