"""The Systems of drakearm, one per file."""

from drakearm.systems.collocation_mpc import CollocationMpc
from drakearm.systems.compiled_skeleton import CompiledSkeleton
from drakearm.systems.delay_line import DelayLine
from drakearm.systems.hill_muscles import HillMuscles, HillMuscles_
from drakearm.systems.joint_stops import JointStops
from drakearm.systems.muscle_drawing import upright
from drakearm.systems.muscle_visualizer import MuscleVisualizer
from drakearm.systems.noise import Noise
from drakearm.systems.policy_controller import PolicyController
from drakearm.systems.proprioception import Proprioception
from drakearm.systems.reach_source import ReachSource
from drakearm.systems.reference_source import ReferenceSource
from drakearm.systems.static_optimizer import StaticOptimizer
from drakearm.systems.tracking_reward import TrackingReward

__all__ = [
    "CollocationMpc",
    "CompiledSkeleton",
    "DelayLine",
    "HillMuscles",
    "HillMuscles_",
    "JointStops",
    "MuscleVisualizer",
    "Noise",
    "PolicyController",
    "Proprioception",
    "ReachSource",
    "ReferenceSource",
    "StaticOptimizer",
    "TrackingReward",
    "upright",
]
