"""The senses: what a controller of the arm observes. The table SENSES is the only place that lists them.

To make a new sense, create a `Sense`. To use it in one task, add it to `TrackingTask.senses`. To make it a part of
drakearm, add it to SENSES.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drakearm.errors import TaskError
from drakearm.model.arm import Arm
from drakearm.task.signals import check_signals, signal_size

SPEED_SCALE = 0.1  # s/rad, makes the joint speeds of a movement dimensionless and near 1
SMALL_ERRORS = (0.01, 0.2)  # rad and rad/s, errors that `small_tracking_error` resolves well

SMALL_ACCUMULATED_ERROR = 0.005  # rad s


@dataclass(frozen=True)
class Sense:
    """One part of an observation: numbers that are computed from signals, each multiplied by a factor.

    - name: each sense of a task needs a different one
    - reads: names of the `SIGNALS` that the sense needs; by default the signal with the name of the sense
    - calc: computes the numbers (..., size) from the arrays of these signals (..., size of the signal); by default it
      returns the signal unchanged. For many arms the arrays have one row per arm, so it must work on the last axis
    - size: how many numbers; by default the size of the first signal
    - scale: computes the factors, one or (size,), from the arm; they make the numbers dimensionless and near 1
    - sets: names of the observation sets that contain the sense
    - meaning: what the scaled numbers are, in words
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


def _small_errors(error: np.ndarray) -> np.ndarray:
    joints = error.shape[-1] // 2
    return np.tanh(error / np.repeat(SMALL_ERRORS, joints))


def _angles_and_speeds(arm: Arm) -> np.ndarray:
    return np.repeat([1.0, SPEED_SCALE], len(arm.coordinates))


SENSES = (  # in the order of the observation. The set "paper" is the observation of Denizdurduran et al. (2022)
    Sense(
        "fiber_length",
        scale=_per_optimal_length,
        sets=("paper", "full", "general"),
        meaning="fiber lengths divided by optimal fiber lengths",
    ),
    Sense(
        "fiber_velocity",
        scale=_per_largest_velocity,
        sets=("paper", "full", "general"),
        meaning="fiber velocities (positive if the fiber lengthens) divided by maximum contraction velocities",
    ),
    Sense("activation", sets=("full", "general"), meaning="activations"),
    Sense("arm_state", scale=_angles_and_speeds, sets=("full", "general"), meaning="q in rad, then 0.1 s/rad times v"),
    Sense("preview_q", sets=("full", "general"), meaning="desired q in rad at each time of the lookahead"),
    Sense(
        "preview_v",
        scale=lambda arm: SPEED_SCALE,
        sets=("full", "general"),
        meaning="0.1 s/rad times desired v at the same times",
    ),
    Sense(
        "tendon_force",
        scale=_per_largest_force,
        sets=("general",),
        meaning="tendon forces divided by maximum isometric forces",
    ),
    Sense("excitation", meaning="excitations during the last control step, 0 at the start"),
    Sense(
        "tracking_error",
        scale=lambda arm: np.repeat([10.0, 1.0], len(arm.coordinates)),
        sets=("general",),
        meaning="10/rad times desired q minus q, then 1 s/rad times desired v minus v",
    ),
    # Without it, a network is too smooth to tell errors of some milliradians from none.
    Sense(
        "small_tracking_error",
        reads=("tracking_error",),
        calc=_small_errors,
        sets=("general",),
        meaning="tanh of the tracking error divided by 0.01 rad and 0.2 rad/s, which resolves small errors",
    ),
    # It lets a policy remove a steady error, for example that of a load which it does not know exactly.
    Sense(
        "accumulated_error",
        calc=lambda error: np.tanh(error / SMALL_ACCUMULATED_ERROR),
        sets=("general",),
        meaning="tanh of the accumulated error divided by 0.005 rad s",
    ),
    Sense(
        "recent_excitation",
        sets=("general",),
        meaning="excitations of the last four control steps, the latest first, 0 before the start",
    ),
)

# The observation sets by name. A user can add a set: `OBSERVATIONS["mine"] = (*OBSERVATIONS["paper"], my_sense)`.
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
    """Computes an observation from signals: the scaled numbers of all senses, one sense after the other.

    reads: names of the signals that it needs. places: the slice of the observation for each sense, by name. size: the
    length of the observation.
    """

    def __init__(self, arm: Arm, senses: Sequence[Sense], lookahead: tuple[int, ...]):
        """Raises TaskError if there are no senses, or if two have the same name."""
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

        Raises TaskError if a sense computes an array whose last axis does not have the size of the sense.
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
                f"The senses computed the shapes {', '.join(shapes)}: expected the last axes {', '.join(sizes)}."
            ) from error
