"""The episode: how one run of a task starts, and how its arm differs from the one that the controller expects.

To make a randomization of your own, derive a frozen dataclass from `Randomization` and put an instance into
`TrackingTask.randomization`. With a `type` of its own it can also stand in repertoire files.
"""

from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, InstanceOf

from drakearm.errors import TaskError, shown
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import NonNegative, Positive
from drakearm.files.kinds import Kind
from drakearm.model.reference import CONTROL_STEP
from drakearm.task.starts import StartState

LONGEST_STEPS = 20  # control steps
LONGEST_DELAY = LONGEST_STEPS * CONTROL_STEP  # s, of the senses
LARGEST_LOAD = 1000.0  # kg
STRENGTHS = (0.01, 100.0)  # the smallest and the largest factor of a force
_LARGEST_NOISE = 10.0
_Load = Annotated[NonNegative, Field(le=LARGEST_LOAD)]
_Strength = Annotated[Positive, Field(ge=STRENGTHS[0], le=STRENGTHS[1])]
Delay = Annotated[NonNegative, Field(le=LONGEST_DELAY)]


class Episode(NamedTuple):
    """One run of a task."""

    start: StartState
    load_mass: float  # kg, in the hand
    strength: float | np.ndarray = 1.0  # factors of the maximum isometric forces, one number or (n,)
    senses_delay: float = 0.0  # s, a whole number of control steps: what is sensed of the body is this old
    motor_noise: float = 0.0  # standard deviation of the noise of an excitation, divided by the excitation
    noise_seed: int = 0  # of the motor noise

    def noise_factors(self, steps: int, n: int) -> np.ndarray:
        """What each excitation is multiplied by in each control step, (steps, n): 1 plus the motor noise."""
        if self.motor_noise == 0.0:
            return np.ones((steps, n))
        rng = np.random.default_rng(self.noise_seed)
        return 1.0 + self.motor_noise * rng.standard_normal((steps, n))

    @property
    def delay_steps(self) -> int:
        """The delay in control steps. Raises TaskError if it is too long, or no whole number of them."""
        if not _is_delay(self.senses_delay):
            raise TaskError(f"The senses have {_delay_problem(self.senses_delay)}.")
        return round(self.senses_delay / CONTROL_STEP)

    def problem(self, n: int, steps: int) -> str | None:
        """What is not possible for n muscles and a reference of some steps: found, expected. None if nothing is."""
        if not isinstance(self.start, StartState):
            return f"the start {shown(self.start)}: expected a StartState"
        if not (_is_number(self.start.step, 0, steps - 1) and self.start.step == int(self.start.step)):
            return f"a start at step {shown(self.start.step)}: expected one of the steps 0 to {steps - 1}"
        if not _is_number(self.load_mass, 0.0, LARGEST_LOAD):
            return f"a load_mass of {shown(self.load_mass)}: expected 0 to {LARGEST_LOAD:g} kg"
        if not (_is_number(self.strength, *STRENGTHS) or _are_numbers(self.strength, n, *STRENGTHS)):
            return (
                f"a strength of {shown(self.strength)}: expected one factor or {n}, one per muscle, from "
                f"{STRENGTHS[0]:g} to {STRENGTHS[1]:g}"
            )
        if not _is_delay(self.senses_delay):
            return _delay_problem(self.senses_delay)
        if not _is_number(self.motor_noise, 0.0, _LARGEST_NOISE):
            return f"a motor_noise of {shown(self.motor_noise)}: expected 0 to {_LARGEST_NOISE:g}"
        if not (isinstance(self.noise_seed, int | np.integer) and 0 <= self.noise_seed < 2**63):
            return f"a noise_seed of {shown(self.noise_seed)}: expected a whole number from 0 to 2**63 - 1"
        return None


def _is_number(value: Any, least: float, most: float) -> bool:
    return isinstance(value, float | int | np.floating | np.integer) and bool(least <= value <= most)


def _are_numbers(values: Any, n: int, least: float, most: float) -> bool:
    found = np.asarray(values)
    return found.shape in ((), (n,)) and found.dtype.kind in "fiu" and bool(((found >= least) & (found <= most)).all())


def _is_delay(delay: Any) -> bool:
    steps = delay / CONTROL_STEP if _is_number(delay, 0.0, LONGEST_DELAY) else 0.5
    return abs(steps - round(steps)) < 1e-6


def _delay_problem(delay: Any) -> str:
    return (
        f"a delay of {shown(delay)} s: expected 0 to {LONGEST_DELAY} s, and a whole number of control steps of "
        f"{CONTROL_STEP} s"
    )


class Randomization(Kind):
    """Base of all randomizations: what changes from episode to episode, and what the controller is not told."""

    def __call__(self, episode: Episode, rng: np.random.Generator) -> Episode:
        """The episode with a random change. All random numbers must come from rng."""
        raise NotImplementedError


# As a scenario file has it: see `Kind.read`.
FileRandomization = Annotated[InstanceOf[Randomization], BeforeValidator(Randomization.read)]


def _in_order(least: float, most: float) -> None:
    if least > most:
        raise ValueError(f"found the range {least:g} to {most:g}, expected the smaller number first")


@checked_dataclass()
class RandomLoad(Randomization):
    """The mass in the hand, with equal chances for all masses of a range. It replaces the load of the task."""

    type = "load"
    least: _Load  # kg, the smallest mass
    most: _Load  # kg, the largest mass

    def __post_init__(self) -> None:
        _in_order(self.least, self.most)

    def __call__(self, episode: Episode, rng: np.random.Generator) -> Episode:
        return episode._replace(load_mass=float(rng.uniform(self.least, self.most)))


@checked_dataclass()
class RandomStrength(Randomization):
    """One factor of the maximum isometric forces of all muscles, with equal chances for all factors of a range."""

    type = "strength"
    least: _Strength  # the smallest factor; 1: the forces of the arm's file
    most: _Strength  # the largest factor

    def __post_init__(self) -> None:
        _in_order(self.least, self.most)

    def __call__(self, episode: Episode, rng: np.random.Generator) -> Episode:
        return episode._replace(strength=episode.strength * float(rng.uniform(self.least, self.most)))


@checked_dataclass()
class RandomStart(Randomization):
    """Offsets of the start, drawn for each joint: of its angle, and of its speed, with equal chances up to a limit."""

    type = "start"
    angle_deg: Annotated[NonNegative, Field(le=90.0)] = 0.0  # degrees, the largest offset, in both directions
    speed: Annotated[NonNegative, Field(le=100.0)] = 0.0  # rad/s, the largest offset, in both directions

    def __call__(self, episode: Episode, rng: np.random.Generator) -> Episode:
        start = episode.start
        q = start.q + np.deg2rad(self.angle_deg) * rng.uniform(-1.0, 1.0, len(start.q))
        v = start.v + self.speed * rng.uniform(-1.0, 1.0, len(start.q))
        return episode._replace(start=start._replace(q=q, v=v))


@checked_dataclass()
class RandomDelay(Randomization):
    """The delay of the senses, with equal chances for all whole control steps of a range."""

    type = "senses_delay"
    least: Delay  # s, the shortest delay, rounded to whole control steps of 0.01 s
    most: Delay  # s, the longest delay, rounded in the same way

    def __post_init__(self) -> None:
        _in_order(self.least, self.most)

    def __call__(self, episode: Episode, rng: np.random.Generator) -> Episode:
        steps = rng.integers(round(self.least / CONTROL_STEP), round(self.most / CONTROL_STEP), endpoint=True)
        return episode._replace(senses_delay=int(steps) * CONTROL_STEP)


@checked_dataclass()
class RandomMotorNoise(Randomization):
    """Noise on excitations that grows with them: signal-dependent noise (Harris and Wolpert 1998).

    Each control step draws it anew for each muscle. The controller knows what it commanded, and not the noise.
    """

    type = "motor_noise"
    share: Annotated[NonNegative, Field(le=_LARGEST_NOISE)]  # standard deviation over the excitation: 0.2 is 20 %

    def __call__(self, episode: Episode, rng: np.random.Generator) -> Episode:
        return episode._replace(motor_noise=self.share, noise_seed=int(rng.integers(2**32)))
