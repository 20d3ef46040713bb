"""TrackingTask: to follow a reference with the muscles. All environments and closed loops are made from it."""

from dataclasses import dataclass
from functools import cached_property

from drakearm.errors import TaskError
from drakearm.model.arm import Arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import Reference
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

    @cached_property
    def observation(self) -> Observation:
        """Computes what a controller observes, from signals."""
        return Observation(self.arm, self.senses, self.lookahead)

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
        check_signals(f"The reward {type(self.reward).__name__}", self.reward.reads)
        self.reward.check(self.arm)
