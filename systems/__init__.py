"""The LeafSystems of drakearm, one a file."""

from drakearm.systems.collocation_mpc import CollocationMpc
from drakearm.systems.compiled_skeleton import CompiledSkeleton
from drakearm.systems.hill_muscles import HillMuscles, HillMuscles_
from drakearm.systems.joint_stops import JointStops
from drakearm.systems.muscle_visualizer import MuscleVisualizer
from drakearm.systems.policy_controller import PolicyController
from drakearm.systems.proprioception import OBSERVATIONS, Proprioception
from drakearm.systems.static_optimizer import StaticOptimizer
from drakearm.systems.tracking_reward import RewardWeights, TrackingReward

__all__ = [
    "OBSERVATIONS",
    "CollocationMpc",
    "CompiledSkeleton",
    "HillMuscles",
    "HillMuscles_",
    "JointStops",
    "MuscleVisualizer",
    "PolicyController",
    "Proprioception",
    "RewardWeights",
    "StaticOptimizer",
    "TrackingReward",
]
