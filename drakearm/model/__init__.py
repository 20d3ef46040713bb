"""What an arm is: its dataclasses, the loader, path functions and the skeleton."""

from drakearm.model.arm import Arm, Muscle, PathTerm
from drakearm.model.loader import load_arm
from drakearm.model.torque_arm import MakeTorqueArm

__all__ = ["Arm", "MakeTorqueArm", "Muscle", "PathTerm", "load_arm"]
