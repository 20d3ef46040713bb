"""The rewards: how good each step of an episode is.

To make a new reward, derive a frozen dataclass from `Reward` and pass an instance as `TrackingTask.reward`.
"""

from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from drakearm.errors import TaskError
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import NonNegative
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
        """The reward (...) from arrays (..., size of the signal). For many arms they have one row per arm.

        So it must work on the last axis, for example with `sum(axis=-1)`.
        """
        raise NotImplementedError

    def check(self, arm: Arm) -> None:
        """Raises TaskError if the reward does not fit the arm. By default, every reward fits every arm."""

    def priority(self, arm: Arm) -> np.ndarray:
        """The priority (n_q,) of each joint, from 0 to 1, in static optimization. By default all joints are alike.

        It matters where the muscles are too weak for all joints: see `acceleration_weighting`.
        """
        return np.ones(len(arm.coordinates))


def check_computed(reward: Reward, computed: Any, arms: int | None = None) -> Any:
    """Returns what a reward computed for one arm, or for several arms with one row each.

    Raises TaskError unless it is one number per arm.
    """
    values = np.asarray(computed)
    if values.shape != (() if arms is None else (arms,)) or values.dtype.kind not in "fiub":
        found = "None" if computed is None else f"the shape {values.shape}"
        expected = "a single number" if arms is None else f"({arms},), one number per arm"
        raise TaskError(f"The reward {type(reward).__name__} computed {found}: expected {expected}.")
    return values


@checked_dataclass()
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
        _check_weights(arm, position=self.position, velocity=self.velocity, acceleration=self.acceleration)

    def priority(self, arm: Arm) -> np.ndarray:
        """The squares of the position weights, divided by the largest one."""
        return _squares(self.position)

    @cached_property
    def _weights(self) -> np.ndarray:
        return np.array([*self.position, *self.velocity, *self.acceleration])

    def __call__(self, *signals: np.ndarray) -> Any:
        arm_state, reference, acceleration = signals
        penalized = np.concatenate([reference - arm_state, acceleration], axis=-1)
        return -(self._weights * penalized**2).sum(axis=-1)


@checked_dataclass()
class AbsoluteErrors(Reward):
    """Minus the weighted absolute errors, with two weights per coordinate j:

        r = -sum_j (position_j |q_d,j - q_j| + velocity_j |v_d,j - v_j|)

    q_d and v_d are the desired q and v. Squares would let the few difficult movements of a repertoire determine what is
    learned, and would make errors of some milliradians cost nothing.
    """

    type = "absolute_errors"
    reads = ("arm_state", "reference")

    position: tuple[NonNegative, ...]  # 1/rad
    velocity: tuple[NonNegative, ...]  # s/rad

    def check(self, arm: Arm) -> None:
        """Raises TaskError unless there is one weight of each sort per coordinate."""
        _check_weights(arm, position=self.position, velocity=self.velocity)

    def priority(self, arm: Arm) -> np.ndarray:
        """The squares of the position weights, divided by the largest one."""
        return _squares(self.position)

    @cached_property
    def _weights(self) -> np.ndarray:
        return np.array([*self.position, *self.velocity])

    def __call__(self, *signals: np.ndarray) -> Any:
        arm_state, reference = signals
        return -(self._weights * np.abs(reference - arm_state)).sum(axis=-1)


def _check_weights(arm: Arm, **weights: tuple[float, ...]) -> None:
    for name, given in weights.items():
        if len(given) != len(arm.coordinates):
            raise TaskError(
                f"The reward's {name} has {len(given)} weights: expected {len(arm.coordinates)}, for "
                f"{', '.join(arm.coordinates)}."
            )


def _squares(position: tuple[float, ...]) -> np.ndarray:
    """The squares of position weights, divided by the largest one; all 1 if all weights are 0."""
    weights = np.array(position)
    return (weights / weights.max()) ** 2 if weights.max() > 0.0 else np.ones(len(weights))
