"""The rewards: how good each step of an episode is.

To make a new reward, derive a frozen dataclass from `Reward` and pass an instance as `TrackingTask.reward`.
"""

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from pydantic.dataclasses import dataclass

from drakearm.errors import TaskError
from drakearm.files.fields import STRICT, NonNegative
from drakearm.files.kinds import Kind
from drakearm.model.arm import Arm


class Reward(Kind):
    """Base of all rewards: a function of signals.

    type: the name of the reward in scenario files. reads: names of `SIGNALS`, in the order of the arguments of
    `__call__`. Two rewards may be equal only if they compute the same; for frozen dataclasses this is so.
    `ArmVectorEnv` computes all arms with equal rewards in one call.
    """

    reads: ClassVar[tuple[str, ...]]

    def __call__(self, *signals: np.ndarray) -> Any:
        """The reward (...) from arrays (..., size of the signal). For many arms they have one row per arm."""
        raise NotImplementedError

    def check(self, arm: Arm) -> None:
        """Raises TaskError if the reward does not fit the arm. By default, every reward fits every arm."""

    def priority(self, arm: Arm) -> np.ndarray:
        """The priority (n_q,) of each joint, from 0 to 1, in static optimization. By default all joints are alike.

        It matters where the muscles are too weak for all joints: see `acceleration_weighting`.
        """
        return np.ones(len(arm.coordinates))


@dataclass(frozen=True, config=STRICT)
class RewardWeights(Reward):
    """The reward of eq. 6 of Denizdurduran et al. (2022), with three weights per coordinate j:

        r = -sum_j (position_j (q_d,j - q_j)^2 + velocity_j (v_d,j - v_j)^2 + acceleration_j a_j^2)

    q_d and v_d are the desired q and v, a is the acceleration. The reward is 0 at rest on the reference, else negative.
    """

    type = "weighted_squares"
    reads = ("arm_state", "reference", "arm_acceleration")

    position: tuple[NonNegative, ...]  # 1/rad^2
    velocity: tuple[NonNegative, ...]  # s^2/rad^2
    acceleration: tuple[NonNegative, ...]  # s^4/rad^2

    def check(self, arm: Arm) -> None:
        """Raises TaskError unless there is one weight of each sort per coordinate."""
        for name in ("position", "velocity", "acceleration"):
            count = len(getattr(self, name))
            if count != len(arm.coordinates):
                raise TaskError(
                    f"The reward's {name} has {count} weights: expected {len(arm.coordinates)}, for "
                    f"{', '.join(arm.coordinates)}."
                )

    def priority(self, arm: Arm) -> np.ndarray:
        """The squares of the position weights, divided by the largest one."""
        position = np.array(self.position)
        return (position / position.max()) ** 2 if position.max() > 0.0 else super().priority(arm)

    @cached_property
    def _weights(self) -> np.ndarray:
        return np.array([*self.position, *self.velocity, *self.acceleration])

    def __call__(self, *signals: np.ndarray) -> Any:
        arm_state, reference, acceleration = signals
        penalized = np.concatenate([reference - arm_state, acceleration], axis=-1)
        return -(self._weights * penalized**2).sum(axis=-1)
