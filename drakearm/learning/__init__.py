"""Gymnasium environments, PPO and policies.

Each name is imported when it is first used: a policy acts without PyTorch.
"""

from typing import TYPE_CHECKING

from drakearm.lazy import lazy_attributes

__all__ = ["PAPER", "ArmVectorEnv", "BatchReport", "DiagramEnv", "Policy", "PpoSettings", "imitate", "prepare", "train"]

if TYPE_CHECKING:
    from drakearm.learning.arm_vector_env import ArmVectorEnv
    from drakearm.learning.batch_report import BatchReport
    from drakearm.learning.diagram_env import DiagramEnv
    from drakearm.learning.imitation import imitate
    from drakearm.learning.policy import Policy
    from drakearm.learning.ppo import train
    from drakearm.learning.ppo_settings import PAPER, PpoSettings
    from drakearm.learning.preparation import prepare
else:
    __getattr__, __dir__ = lazy_attributes(
        __name__,
        {
            "drakearm.learning.arm_vector_env": ("ArmVectorEnv",),
            "drakearm.learning.batch_report": ("BatchReport",),
            "drakearm.learning.diagram_env": ("DiagramEnv",),
            "drakearm.learning.imitation": ("imitate",),
            "drakearm.learning.policy": ("Policy",),
            "drakearm.learning.ppo": ("train",),
            "drakearm.learning.ppo_settings": ("PAPER", "PpoSettings"),
            "drakearm.learning.preparation": ("prepare",),
        },
    )
