"""TrackingTask: to follow a reference with the muscles. All environments and closed loops are made from it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from drakearm.errors import TaskError, shown
from drakearm.model.arm import Arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import Reference
from drakearm.task.episode import Episode, Randomization
from drakearm.task.rewards import Reward
from drakearm.task.senses import OBSERVATIONS, Observation, Sense
from drakearm.task.signals import check_signals
from drakearm.task.starts import ReferenceStart, Start

LOOKAHEAD = (0, 3, 8)  # control steps


@dataclass(frozen=True)
class TrackingTask:
    """The reference that an arm follows, what its controller senses, how it is rewarded, and how an episode starts.

    Raises TaskError if the reference or the reward does not fit the arm.
    """

    arm: Arm
    reference: Reference
    reward: Reward
    senses: tuple[Sense, ...] = OBSERVATIONS["full"]
    start: Start = ReferenceStart()  # noqa: RUF009 (it is frozen)
    lookahead: tuple[int, ...] = LOOKAHEAD  # the preview shows the reference this many control steps ahead
    load_mass: float = 0.0  # kg, in the hand
    obstacle: Obstacle | None = None  # only drawn; the reference must already avoid it
    senses_delay: float = 0.0  # s, whole control steps: what the controller senses of its body is this old
    randomization: tuple[Randomization, ...] = ()  # what changes from episode to episode

    @cached_property
    def observation(self) -> Observation:
        """Computes what a controller observes, from signals."""
        return Observation(self.arm, self.senses, self.lookahead)

    def episode(self, rng: np.random.Generator | None) -> Episode:
        """How an episode starts, and what differs in it. rng: source of all that is random; None: nothing is.

        Raises TaskError if the start or a randomization makes an episode that is not possible.
        """
        episode = Episode(self.start(self.reference, rng), self.load_mass, senses_delay=self.senses_delay)
        self._check(episode, "task has")
        if rng is not None:
            for randomization in self.randomization:
                episode = randomization(episode, rng)
                self._check(episode, f"randomization {type(randomization).__name__} drew")
        return episode

    def _check(self, episode: Any, found: str) -> None:
        """Raises TaskError if an episode is not possible. found: the beginning of the message."""
        if not isinstance(episode, Episode):
            raise TaskError(f"The {found} {shown(episode)}: expected an Episode.")
        problem = episode.problem(len(self.arm.muscles), len(self.reference.t) - 1)
        if problem:
            raise TaskError(f"The {found} {problem}.")

    def __post_init__(self) -> None:
        problem = self.reference.problem()
        if problem:
            raise TaskError(f"The arm {self.arm.name} cannot follow the reference: {problem}.")
        joints, coordinates = self.reference.q.shape[1], self.arm.coordinates
        if joints != len(coordinates):
            raise TaskError(
                f"The reference has {joints} joints: expected {len(coordinates)}, the {', '.join(coordinates)} of the "
                f"arm {self.arm.name}."
            )
        if not (
            isinstance(self.randomization, tuple | list)
            and all(isinstance(each, Randomization) for each in self.randomization)
        ):
            raise TaskError(f"The randomization is {shown(self.randomization)}: expected a tuple of Randomizations.")
        _ = self.episode(None)
        check_signals(f"The reward {type(self.reward).__name__}", self.reward.reads)
        self.reward.check(self.arm)


def check_interchangeable(tasks: Sequence[TrackingTask]) -> None:
    """Raises TaskError, which names what differs, unless all tasks can be carried out in one environment.

    They may differ in the reference, the load, the start and the randomization.
    """
    for i, task in enumerate(tasks):
        for name in ("arm", "senses", "lookahead", "reward"):
            if getattr(task, name) != getattr(tasks[0], name):
                raise TaskError(f"Task {i} differs from task 0 in its {name}: expected the same in all tasks.")
