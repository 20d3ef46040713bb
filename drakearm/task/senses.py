"""The senses: what a controller of the arm observes. The table SENSES is the only place that lists them.

A new sense is a `Sense`. For one task, name it in `TrackingTask.senses`; for everybody, add a row to SENSES.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drakearm.errors import TaskError
from drakearm.model.arm import Arm
from drakearm.task.signals import check_signals, signal_size

SPEED_SCALE = 0.1  # s/rad: joint speeds of a movement become numbers near 1


@dataclass(frozen=True)
class Sense:
    """One part of an observation: numbers that are computed from signals, and a factor for each of them.

    reads: names of `SIGNALS`; by default the one with the name of the sense. calc: from the arrays of these signals,
    (..., size of the signal), to (..., size); by default the signal as it is. The arrays have one row per arm where
    many arms are simulated together, so it works on the last axis. size: by default that of the signal. scale: from the
    arm to the factors, one or (size,), which make the numbers dimensionless and near 1. sets: the names of the
    observation sets that the sense belongs to. meaning: what the observation holds, in words.
    """

    name: str
    reads: tuple[str, ...] = ()
    calc: Callable[..., np.ndarray] | None = None
    size: int | None = None
    scale: Callable[[Arm], ArrayLike] = lambda arm: 1.0
    sets: tuple[str, ...] = ()
    meaning: str = ""

    def __post_init__(self) -> None:
        if not self.reads:
            object.__setattr__(self, "reads", (self.name,))
        check_signals(f"The sense {self.name}", self.reads, of_sense=True)
        if self.calc is None and len(self.reads) != 1:
            raise TaskError(f"The sense {self.name} reads {len(self.reads)} signals: expected a calc to combine them.")


def _per_optimal_length(arm: Arm) -> np.ndarray:
    return 1.0 / arm.muscle_table["optimal_fiber_length"]


def _per_largest_velocity(arm: Arm) -> np.ndarray:
    muscles = arm.muscle_table
    return 1.0 / (muscles["optimal_fiber_length"] * muscles["max_contraction_velocity"])


def _per_largest_force(arm: Arm) -> np.ndarray:
    return 1.0 / arm.muscle_table["max_isometric_force"]


def _angles_and_speeds(arm: Arm) -> np.ndarray:
    return np.repeat([1.0, SPEED_SCALE], len(arm.coordinates))


SENSES = (  # in the order of the observation; "paper" is what Denizdurduran et al. (2022) observe
    Sense(
        "fiber_length",
        scale=_per_optimal_length,
        sets=("paper", "full"),
        meaning="fiber lengths over their optimal lengths",
    ),
    Sense(
        "fiber_velocity",
        scale=_per_largest_velocity,
        sets=("paper", "full"),
        meaning="fiber velocities over the largest contraction velocities",
    ),
    Sense("activation", sets=("full",), meaning="activations"),
    Sense("arm_state", scale=_angles_and_speeds, sets=("full",), meaning="q in rad, then v in rad/s times 0.1"),
    Sense("preview_q", sets=("full",), meaning="desired q in rad, at each time of the lookahead"),
    Sense(
        "preview_v",
        scale=lambda arm: SPEED_SCALE,
        sets=("full",),
        meaning="desired v in rad/s times 0.1, at the same times",
    ),
    Sense("tendon_force", scale=_per_largest_force, meaning="tendon forces over the largest isometric forces"),
    Sense("excitation", meaning="the excitations that were held until now"),
)

# The observation sets by name. A user's own: `OBSERVATIONS["mine"] = (*OBSERVATIONS["paper"], my_sense)`.
OBSERVATIONS = {
    name: tuple(sense for sense in SENSES if name in sense.sets)
    for name in dict.fromkeys(name for sense in SENSES for name in sense.sets)
}


def observation_set(name: str) -> tuple[Sense, ...]:
    """The senses of a set. Raises TaskError for a name that is not in OBSERVATIONS."""
    if name not in OBSERVATIONS:
        raise TaskError(f"There is no observation set {name!r}: expected one of {', '.join(OBSERVATIONS)}.")
    return OBSERVATIONS[name]


class Observation:
    """Senses side by side, scaled: the function from signals to the observation.

    reads: the signals that it needs. places: the slice of each sense in the observation. size: of the observation.
    """

    def __init__(self, arm: Arm, senses: Sequence[Sense], lookahead: tuple[int, ...]):
        """Raises TaskError for no senses at all and for two senses of one name."""
        names = [sense.name for sense in senses]
        if not names or len(set(names)) < len(names):
            raise TaskError(
                f"The task has the senses {', '.join(names) or 'none'}: expected at least one, and each only once."
            )
        self._senses = tuple(senses)
        sizes = [signal_size(s.reads[0], arm, lookahead) if s.size is None else s.size for s in senses]
        scales = zip(senses, sizes, strict=True)
        self._scale = np.concatenate([np.broadcast_to(sense.scale(arm), size) for sense, size in scales])
        self.reads = tuple(dict.fromkeys(name for sense in senses for name in sense.reads))
        ends = np.cumsum(sizes).tolist()
        self.places = {name: slice(end - n, end) for name, end, n in zip(names, ends, sizes, strict=True)}
        self.size = len(self._scale)

    def __call__(self, signals: Mapping[str, Any]) -> np.ndarray:
        """The observation (..., size) from the arrays of its signals.

        Raises TaskError where a sense computes another size than it says.
        """
        parts = [
            signals[sense.reads[0]] if sense.calc is None else sense.calc(*(signals[name] for name in sense.reads))
            for sense in self._senses
        ]
        try:
            return np.concatenate(parts, axis=-1) * self._scale
        except ValueError as error:
            shapes = [f"{sense.name} {np.shape(part)}" for sense, part in zip(self._senses, parts, strict=True)]
            sizes = [f"{name} {place.stop - place.start}" for name, place in self.places.items()]
            raise TaskError(
                f"The senses have the shapes {', '.join(shapes)}: expected on the last axis {', '.join(sizes)}."
            ) from error
