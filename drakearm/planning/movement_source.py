"""Sources of movements: where the movements come from that one policy shall learn."""

from dataclasses import replace
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, InstanceOf, field_validator, model_validator

from drakearm.errors import PlanningError
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Degrees, NonNegative, Positive, Vector
from drakearm.files.kinds import Kind
from drakearm.model import MakeTorqueArm
from drakearm.model.arm import Arm
from drakearm.model.reference import CONTROL_STEP
from drakearm.model.skeleton import hand_motion
from drakearm.planning.costs import Cost
from drakearm.planning.movement import Movement
from drakearm.planning.reach import reach

_TRIES = 10_000  # postures that are drawn until the hand is where it should be


class Drawn(NamedTuple):
    """A movement that a source has drawn."""

    movement: Movement
    load_mass: float  # kg, in the hand


class MovementSource(Kind):
    """Base of all sources. A source of your own is a frozen dataclass with a `type` that derives from this class.

    A scenario file can name it by its `type` once the module that defines it is imported.
    """

    def pick(self, rng: np.random.Generator) -> "MovementSource":
        """The source that draws the next movement: by default this one. See `Mixture`."""
        return self

    def draw(self, arm: Arm, rng: np.random.Generator) -> Drawn:
        """Draws a movement. It need not be one that the muscles can make: `plan_library` tests this.

        All random numbers must come from rng. Raises PlanningError if there is nothing to draw.
        """
        raise NotImplementedError


Source = Annotated[InstanceOf[MovementSource], BeforeValidator(MovementSource.read)]  # as a file has it
_Seconds = Annotated[Positive, Field(le=60.0)]
_Kilograms = Annotated[NonNegative, Field(le=1000.0)]


@checked_dataclass(kw_only=True)
class Reaches(MovementSource):
    """Movements from rest at one posture to rest at another one. All numbers are drawn from ranges with equal chances.

    A target is a posture, drawn from target_deg. With target_box, postures are drawn until the hand is in the box.
    """

    type = "reaches"
    start_deg: tuple[tuple[Degrees, Degrees], ...]  # per coordinate
    target_deg: tuple[tuple[Degrees, Degrees], ...]  # per coordinate
    target_box: tuple[Vector, Vector] | None = None  # m, lowest and highest x, y and z of the hand, in the world
    least_way_deg: NonNegative = 10.0  # by which at least one joint turns
    duration: tuple[_Seconds, _Seconds]
    load_mass: tuple[_Kilograms, _Kilograms] = (0.0, 0.0)
    hold: Annotated[NonNegative, Field(le=60.0)] = 0.2  # s of rest after the end
    # The three that follow are by default those of `drakearm.planning.reach`, as in the shipped reaches.
    speed_limit: tuple[Positive, ...] | None = None  # rad/s, per coordinate
    torque_limit: tuple[Positive, ...] | None = None  # Nm, per coordinate
    costs: Annotated[list[Cost], Field(min_length=1, max_length=50)] | None = None

    @field_validator("start_deg", "target_deg")
    @classmethod
    def _ordered_each(cls, ranges: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        for low, high in ranges:
            cls._ordered((low, high))
        return ranges

    @field_validator("duration", "load_mass")
    @classmethod
    def _ordered(cls, limits: tuple[float, float]) -> tuple[float, float]:
        if limits[0] > limits[1]:
            raise ValueError(f"found the range {limits[0]:g} to {limits[1]:g}, expected the smaller number first")
        return limits

    def draw(self, arm: Arm, rng: np.random.Generator) -> Drawn:
        """Raises PlanningError if no posture has the hand at the target, or none is far enough from the start."""
        for _ in range(_TRIES):
            start, target = (rng.uniform(*np.transpose(ranges)) for ranges in (self.start_deg, self.target_deg))
            if np.abs(target - start).max() >= self.least_way_deg and self._hand_is_there(arm, target):
                break
        else:
            raise PlanningError("The source finds no target: expected wider ranges of target_deg or target_box.")
        shortest, longest = (round(limit / CONTROL_STEP) for limit in self.duration)
        steps = int(rng.integers(shortest, longest, endpoint=True))
        usual = reach(start.tolist(), target.tolist(), steps * CONTROL_STEP, self.hold)
        own = {name: getattr(self, name) for name in ("speed_limit", "torque_limit", "costs")}
        movement = replace(usual, **{name: value for name, value in own.items() if value is not None})
        return Drawn(movement, float(rng.uniform(*self.load_mass)))

    def _hand_is_there(self, arm: Arm, target: np.ndarray) -> bool:
        if self.target_box is None:
            return True
        q = np.deg2rad(target)[None]
        p_WH = hand_motion(MakeTorqueArm(arm), arm, q, np.zeros_like(q))[0][0]
        lowest, highest = self.target_box
        return bool(np.all(p_WH >= lowest) and np.all(p_WH <= highest))


@checked_dataclass(kw_only=True)
class Mixture(MovementSource):
    """Movements of several sources. Each movement comes from one of them, which is drawn with the chances `shares`.

    The source is drawn once per movement, so that the shares are also those of the movements that the muscles can make.
    """

    type = "mixture"
    sources: Annotated[list[Source], Field(min_length=1, max_length=50)]
    shares: Annotated[list[Positive], Field(min_length=1, max_length=50)]  # one per source; their sum need not be 1

    @model_validator(mode="after")
    def _one_share_each(self) -> "Mixture":
        if len(self.shares) != len(self.sources):
            raise ValueError(f"found {len(self.shares)} shares, expected {len(self.sources)}, one per source")
        return self

    def pick(self, rng: np.random.Generator) -> MovementSource:
        shares = np.array(self.shares) / np.sum(self.shares)
        return self.sources[int(rng.choice(len(shares), p=shares))].pick(rng)

    def draw(self, arm: Arm, rng: np.random.Generator) -> Drawn:
        return self.pick(rng).draw(arm, rng)
