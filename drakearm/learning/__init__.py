"""Gymnasium environments, PPO and policies."""

from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.learning.diagram_env import DiagramEnv
from drakearm.learning.imitation import imitate
from drakearm.learning.policy import Policy
from drakearm.learning.ppo import PAPER, BatchReport, PpoSettings, train
from drakearm.learning.preparation import prepare

__all__ = ["PAPER", "ArmVectorEnv", "BatchReport", "DiagramEnv", "Policy", "PpoSettings", "imitate", "prepare", "train"]
