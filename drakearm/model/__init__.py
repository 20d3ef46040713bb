"""What a limb is: its dataclasses, the loader, path functions and the skeleton; references and recordings of it."""

from drakearm.files import Kind
from drakearm.model.arm import Arm, Capsule, Muscle
from drakearm.model.equilibrium import Equilibrium, find_equilibrium
from drakearm.model.feedback import Feedback
from drakearm.model.inspection import inspect_arm
from drakearm.model.isometric import Isometric, isometric_torque, joint_stiffness
from drakearm.model.loader import load_arm
from drakearm.model.motion import Motion
from drakearm.model.musculature import RESTING_ACTIVATION, muscle_geometry
from drakearm.model.obstacle import Obstacle
from drakearm.model.path_terms import PathTerm, TensorTerm
from drakearm.model.recording import Recording, load_recordings, save_recordings
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.model.torque_arm import MakeTorqueArm

__all__ = [
    "CONTROL_STEP",
    "RESTING_ACTIVATION",
    "Arm",
    "Capsule",
    "Equilibrium",
    "Feedback",
    "Isometric",
    "Kind",
    "MakeTorqueArm",
    "Motion",
    "Muscle",
    "Obstacle",
    "PathTerm",
    "Recording",
    "Reference",
    "TensorTerm",
    "find_equilibrium",
    "inspect_arm",
    "isometric_torque",
    "joint_stiffness",
    "load_arm",
    "load_recordings",
    "muscle_geometry",
    "save_recordings",
]
