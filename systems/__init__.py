"""The Systems of drakearm, one per file."""

from typing import TYPE_CHECKING, Any

from drakearm.systems.collocation_mpc import CollocationMpc
from drakearm.systems.compiled_skeleton import CompiledSkeleton_
from drakearm.systems.delay_line import DelayLine
from drakearm.systems.hill_muscles import HillMuscles_
from drakearm.systems.joint_stops import JointStops_
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

# The instantiations for doubles. Drake takes 0.1 s for each that is made during an import, and no time later.
if TYPE_CHECKING:
    CompiledSkeleton, HillMuscles, JointStops = CompiledSkeleton_[None], HillMuscles_[None], JointStops_[None]
else:
    _TEMPLATES = {"CompiledSkeleton": CompiledSkeleton_, "HillMuscles": HillMuscles_, "JointStops": JointStops_}

    def __getattr__(name: str) -> Any:
        if name not in _TEMPLATES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return globals().setdefault(name, _TEMPLATES[name][None])

    def __dir__() -> list[str]:
        return sorted({*globals(), *_TEMPLATES})
