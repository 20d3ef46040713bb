"""Gymnasium environments, PPO and policies."""

from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.learning.batch_report import BatchReport
from drakearm.learning.diagram_env import DiagramEnv
from drakearm.learning.imitation import imitate
from drakearm.learning.policy import Policy
from drakearm.learning.ppo import train
from drakearm.learning.ppo_settings import PAPER, PpoSettings
from drakearm.learning.preparation import prepare

__all__ = ["PAPER", "ArmVectorEnv", "BatchReport", "DiagramEnv", "Policy", "PpoSettings", "imitate", "prepare", "train"]
