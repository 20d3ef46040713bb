"""The rewards: how good each step of an episode is.

A new reward is a frozen dataclass that derives from `Reward`; give one to `TrackingTask.reward`.
"""

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from pydantic.dataclasses import dataclass

from drakearm.model.fields import STRICT, NonNegative
from drakearm.model.kinds import Kind


class Reward(Kind):
    """Base of all rewards: a function of signals.

    type: the name that a scenario file gives the reward. reads: names of `SIGNALS`, in the order of the call's
    arguments. Rewards are equal where they compute the same, as frozen dataclasses are: the rewards of all arms that
    have equal ones are computed together.
    """

    reads: ClassVar[tuple[str, ...]]

    def __call__(self, *signals: np.ndarray) -> Any:
        """The reward (...) from arrays (..., size of the signal), with one row per arm where there are many arms."""
        raise NotImplementedError


@dataclass(frozen=True, config=STRICT)
class RewardWeights(Reward):
    """The reward of eq. 6 of Denizdurduran et al. (2022) with its weights, one per coordinate.

    Minus the weighted squares of position errors, velocity errors and accelerations: 0 on the reference at rest.
    """

    type = "weighted_squares"
    reads = ("arm_state", "reference", "arm_acceleration")

    position: tuple[NonNegative, ...]  # 1/rad^2
    velocity: tuple[NonNegative, ...]  # s^2/rad^2
    acceleration: tuple[NonNegative, ...]  # s^4/rad^2

    @cached_property
    def _weights(self) -> np.ndarray:
        return np.array([*self.position, *self.velocity, *self.acceleration])

    def __call__(self, *signals: np.ndarray) -> Any:
        arm_state, reference, acceleration = signals
        lost = np.concatenate([reference - arm_state, acceleration], axis=-1)
        return -(self._weights * lost**2).sum(axis=-1)
