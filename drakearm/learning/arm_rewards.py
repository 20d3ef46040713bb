"""The rewards of many arms, whose tasks may have different ones."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from drakearm.task import Reward
from drakearm.task.rewards import check_computed


class ArmRewards:
    """Computes the rewards of all arms, with one call for each distinct reward.

    reads: names of all signals that the rewards read.
    """

    def __init__(self, rewards: Sequence[Reward]):
        """rewards: of the tasks."""
        self._distinct: list[Reward] = []
        for reward in rewards:
            if reward not in self._distinct:
                self._distinct.append(reward)
        self._of_task = np.array([self._distinct.index(reward) for reward in rewards])
        self.reads = tuple(dict.fromkeys(name for reward in self._distinct for name in reward.reads))

    def __call__(self, signals: Mapping[str, Callable[[], np.ndarray]], task_of_arm: np.ndarray) -> np.ndarray:
        """The rewards (N,). task_of_arm: (N,). Raises TaskError if a reward does not compute one number per arm."""
        count = len(task_of_arm)
        if len(self._distinct) == 1:
            reward = self._distinct[0]
            return check_computed(reward, reward(*(signals[name]() for name in reward.reads)), count)
        reward_of_arm, total = self._of_task[task_of_arm], np.empty(count)
        for k, reward in enumerate(self._distinct):
            arms = np.flatnonzero(reward_of_arm == k)
            if len(arms):
                computed = reward(*(signals[name]()[arms] for name in reward.reads))
                total[arms] = check_computed(reward, computed, len(arms))
        return total
