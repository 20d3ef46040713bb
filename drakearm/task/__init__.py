"""The task: what an arm follows, what its controller senses, how it is rewarded, and how an episode starts."""

from drakearm.task.episode import (
    Episode,
    RandomDelay,
    Randomization,
    RandomLoad,
    RandomMotorNoise,
    RandomStart,
    RandomStrength,
)
from drakearm.task.rewards import AbsoluteErrors, Reward, RewardWeights
from drakearm.task.senses import OBSERVATIONS, SENSES, Observation, Sense, observation_set
from drakearm.task.signals import SIGNALS, signal_size
from drakearm.task.starts import ReferenceStart, Start, StartState
from drakearm.task.tracking_task import LOOKAHEAD, TrackingTask, check_interchangeable

__all__ = [
    "LOOKAHEAD",
    "OBSERVATIONS",
    "SENSES",
    "SIGNALS",
    "AbsoluteErrors",
    "Episode",
    "Observation",
    "RandomDelay",
    "RandomLoad",
    "RandomMotorNoise",
    "RandomStart",
    "RandomStrength",
    "Randomization",
    "ReferenceStart",
    "Reward",
    "RewardWeights",
    "Sense",
    "Start",
    "StartState",
    "TrackingTask",
    "check_interchangeable",
    "observation_set",
    "signal_size",
]
