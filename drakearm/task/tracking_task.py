"""TrackingTask: follow a reference with the muscles. Every environment and every loop reads it from here."""

from dataclasses import dataclass
from functools import cached_property

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
    """What is to be followed, with what, how it is sensed and rewarded, and how an episode starts."""

    arm: Arm
    reference: Reference
    reward: Reward
    senses: tuple[Sense, ...] = OBSERVATIONS["full"]
    start: Start = ReferenceStart()  # noqa: RUF009 (it is frozen)
    lookahead: tuple[int, ...] = LOOKAHEAD  # control steps ahead at which the preview shows the reference
    load_mass: float = 0.0  # kg, in the hand
    obstacle: Obstacle | None = None  # drawn; the reference goes around it

    @cached_property
    def observation(self) -> Observation:
        """From signals to what a controller observes."""
        return Observation(self.arm, self.senses, self.lookahead)

    def __post_init__(self) -> None:
        check_signals(f"The reward {type(self.reward).__name__}", self.reward.reads)
