"""The starts: in which state an episode begins.

A new start is a frozen dataclass that derives from `Start`; give one to `TrackingTask.start`.
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
    """The state of an arm as an episode begins. Fibers are in equilibrium with the tendons there."""

    q: np.ndarray  # (n_q,) rad; brought into the joints' ranges
    v: np.ndarray  # (n_q,) rad/s
    activation: float | np.ndarray = RESTING_ACTIVATION  # one for all muscles, or (n,)
    step: int = 0  # of the reference, in control steps from its start: the episode is shorter by this many


class Start(ABC):
    """Base of all starts."""

    @abstractmethod
    def __call__(self, reference: Reference, rng: np.random.Generator | None) -> StartState:
        """The state in which an episode begins that follows a reference. Without a generator there is no noise."""

    def random_posture(self, reference: Reference) -> Sequence[Expression]:
        """The joint angles (n_q,), rad, with Drake's random variables, for Drake's `SetRandomContext`.

        By default those without noise.
        """
        return [Expression(float(angle)) for angle in self(reference, None).q]


@dataclass(frozen=True)
class ReferenceStart(Start):
    """At rest at the start of the reference, with noise on the joint angles."""

    noise: float = 0.0  # rad, standard deviation

    def __call__(self, reference: Reference, rng: np.random.Generator | None) -> StartState:
        q = reference.q[0]
        if rng is not None:
            q = q + self.noise * rng.standard_normal(len(q))
        return StartState(q, np.zeros(len(q)))

    def random_posture(self, reference: Reference) -> Sequence[Expression]:
        return [
            float(angle) + self.noise * Variable(f"start_noise_{j}", Variable.Type.RANDOM_GAUSSIAN)
            for j, angle in enumerate(reference.q[0])
        ]
