"""drakearm: a human arm with Hill-type muscles in Drake; plan with optimal control, learn excitations with PPO.

The names in `__all__` are the public ones. Each is imported when it is first used.
"""

from pathlib import Path
from typing import TYPE_CHECKING

from drakearm.gymnasium_registration import register_with_gymnasium
from drakearm.lazy import lazy_attributes

# In a checkout `systems` and `diagrams` stand beside this folder; Python started there imports the checkout itself.
_checkout = Path(__file__).parent.parent
if (_checkout / "pyproject.toml").is_file():
    __path__.append(str(_checkout))

register_with_gymnasium()

__all__ = [
    "Arm",
    "ArmVectorEnv",
    "DiagramEnv",
    "Movement",
    "Muscle",
    "Obstacle",
    "Plan",
    "Policy",
    "PpoSettings",
    "Recording",
    "Reference",
    "Reward",
    "RunFolder",
    "Scenario",
    "Sense",
    "Start",
    "StartState",
    "TrackingTask",
    "__version__",
    "evaluate_step",
    "find_equilibrium",
    "load_arm",
    "load_scenario",
    "make_env",
    "make_vector_env",
    "muscle_feasibility",
    "plan",
    "plan_step",
    "replay_step",
    "train",
    "train_step",
    "upright",
    "write_replay",
]

if TYPE_CHECKING:
    from drakearm.experiments import (
        RunFolder,
        Scenario,
        evaluate_step,
        load_scenario,
        make_env,
        make_vector_env,
        plan_step,
        replay_step,
        train_step,
    )
    from drakearm.learning import ArmVectorEnv, DiagramEnv, Policy, PpoSettings, train
    from drakearm.model import Arm, Muscle, Obstacle, Recording, Reference, find_equilibrium, load_arm
    from drakearm.planning import Movement, Plan, muscle_feasibility, plan
    from drakearm.replay import write_replay
    from drakearm.systems import upright
    from drakearm.task import Reward, Sense, Start, StartState, TrackingTask
    from drakearm.version import __version__
else:
    __getattr__, __dir__ = lazy_attributes(
        __name__,
        {
            "drakearm.experiments": (
                "RunFolder",
                "Scenario",
                "evaluate_step",
                "load_scenario",
                "make_env",
                "make_vector_env",
                "plan_step",
                "replay_step",
                "train_step",
            ),
            "drakearm.learning": ("ArmVectorEnv", "DiagramEnv", "Policy", "PpoSettings", "train"),
            "drakearm.model": ("Arm", "Muscle", "Obstacle", "Recording", "Reference", "find_equilibrium", "load_arm"),
            "drakearm.planning": ("Movement", "Plan", "muscle_feasibility", "plan"),
            "drakearm.replay": ("write_replay",),
            "drakearm.systems": ("upright",),
            "drakearm.task": ("Reward", "Sense", "Start", "StartState", "TrackingTask"),
            "drakearm.version": ("__version__",),
        },
    )
