"""Functions that build Diagrams from the Systems of Drake and drakearm."""

from drakearm.diagrams.hand_force import HandForce
from drakearm.diagrams.mpc_loop import MakeMpcLoop, MpcLoop
from drakearm.diagrams.muscle_arm import AddMuscleArm, AddMuscles, MakeSimulator, MuscleArm
from drakearm.diagrams.perturbation import Perturbation
from drakearm.diagrams.perturbations import ExtraLoad, MotorNoise, Push, SensorDelay, Strength
from drakearm.diagrams.policy_loop import MakePolicyLoop
from drakearm.diagrams.reaching_loop import MakeReachingLoop, ReachingLoop
from drakearm.diagrams.recorder import AddRecorder, Recorder
from drakearm.diagrams.start_perturbations import StartNoise, StartOffset
from drakearm.diagrams.static_loop import MakeStaticLoop
from drakearm.diagrams.tracking_loop import TrackingLoop
from drakearm.diagrams.tracking_task import AddTrackingTask, MakeTrackingTask, TaskSystems
from drakearm.diagrams.visualization import AddMuscleVisualizer

__all__ = [
    "AddMuscleArm",
    "AddMuscleVisualizer",
    "AddMuscles",
    "AddRecorder",
    "AddTrackingTask",
    "ExtraLoad",
    "HandForce",
    "MakeMpcLoop",
    "MakePolicyLoop",
    "MakeReachingLoop",
    "MakeSimulator",
    "MakeStaticLoop",
    "MakeTrackingTask",
    "MotorNoise",
    "MpcLoop",
    "MuscleArm",
    "Perturbation",
    "Push",
    "ReachingLoop",
    "Recorder",
    "SensorDelay",
    "StartNoise",
    "StartOffset",
    "Strength",
    "TaskSystems",
    "TrackingLoop",
]
