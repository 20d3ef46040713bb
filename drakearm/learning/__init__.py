"""Gymnasium environments, PPO and policies."""

from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.learning.diagram_env import DiagramEnv
from drakearm.learning.policy import Policy
from drakearm.learning.ppo import BatchReport, PpoSettings, train

__all__ = ["ArmVectorEnv", "BatchReport", "DiagramEnv", "Policy", "PpoSettings", "train"]
