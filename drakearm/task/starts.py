"""The starts: the state in which an episode begins.

To make a new start, derive a frozen dataclass from `Start` and pass an instance as `TrackingTask.start`.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from pydrake.symbolic import Expression, Variable

from drakearm.model.musculature import RESTING_ACTIVATION
from drakearm.model.reference import Reference


class StartState(NamedTuple):
    """The state of an arm at the start of an episode. Each fiber starts in equilibrium with its tendon."""

    q: np.ndarray  # (n_q,) rad; it will be clipped to the joints' ranges
    v: float | np.ndarray = 0.0  # rad/s, one number for all joints, or (n_q,)
    activation: float | np.ndarray = RESTING_ACTIVATION  # 0..1, one number for all muscles, or (n,)
    step: int = 0  # of the reference, at which the episode starts; it is shorter by this many control steps


class Start(ABC):
    """Base of all starts."""

    @abstractmethod
    def __call__(self, reference: Reference, rng: np.random.Generator | None) -> StartState:
        """The state at the start of an episode with this reference. rng: source of the noise; None: no noise."""

    def random_posture(self, reference: Reference) -> Sequence[Expression]:
        """The joint angles (n_q,), rad, as expressions with Drake's random variables, for Drake's `SetRandomContext`.

        By default they have no noise.
        """
        return [Expression(float(angle)) for angle in self(reference, None).q]


@dataclass(frozen=True)
class ReferenceStart(Start):
    """At rest at the first posture of the reference, with noise on the joint angles."""

    noise: float = 0.0  # rad, standard deviation

    def __call__(self, reference: Reference, rng: np.random.Generator | None) -> StartState:
        q = reference.q[0]
        if rng is not None:
            q = q + self.noise * rng.standard_normal(len(q))
        return StartState(q)

    def random_posture(self, reference: Reference) -> Sequence[Expression]:
        return [
            float(angle) + self.noise * Variable(f"start_noise_{j}", Variable.Type.RANDOM_GAUSSIAN)
            for j, angle in enumerate(reference.q[0])
        ]
