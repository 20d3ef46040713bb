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
    "RunFolder",
    "Scenario",
    "__version__",
    "evaluate_step",
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
    from drakearm.model import Arm, Muscle, load_arm
    from drakearm.model.obstacle import Obstacle
    from drakearm.model.recording import Recording
    from drakearm.model.reference import Reference
    from drakearm.planning import Movement, Plan, plan
    from drakearm.planning.feasibility import muscle_feasibility
    from drakearm.replay import write_replay
    from drakearm.systems.muscle_visualizer import upright
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
            "drakearm.model": ("Arm", "Muscle", "load_arm"),
            "drakearm.model.obstacle": ("Obstacle",),
            "drakearm.model.recording": ("Recording",),
            "drakearm.model.reference": ("Reference",),
            "drakearm.planning": ("Movement", "Plan", "plan"),
            "drakearm.planning.feasibility": ("muscle_feasibility",),
            "drakearm.replay": ("write_replay",),
            "drakearm.systems.muscle_visualizer": ("upright",),
            "drakearm.version": ("__version__",),
        },
    )
