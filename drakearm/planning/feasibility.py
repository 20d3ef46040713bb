"""Is a reference feasible for the muscles? Static optimization at every sample, and the torque that is missing."""

from dataclasses import dataclass

import numpy as np

from drakearm.diagrams import MakeTorqueArm
from drakearm.model import Arm
from drakearm.model.reference import Reference
from drakearm.model.static_optimization import static_activations
from drakearm.planning.torques import inverse_dynamics

NEGLIGIBLE = 0.01  # Nm, reserve torque that counts as none


@dataclass(frozen=True)
class Feasibility:
    """At times t (N,), s: the torques a movement takes, the smallest activations, and what these cannot exert.

    activation: (N, n), of least sum of squares. required, reserve: torques (N, n_q), Nm; the muscles exert their
    difference.
    """

    coordinates: tuple[str, ...]
    t: np.ndarray
    activation: np.ndarray
    required: np.ndarray
    reserve: np.ndarray

    @property
    def feasible(self) -> bool:
        """Whether the muscles are strong and quick enough for every sample."""
        return bool(np.abs(self.reserve).max() <= NEGLIGIBLE)

    @property
    def verdict(self) -> str:
        """One sentence: how hard the muscles work, or which joint lacks how much torque, and when."""
        if self.feasible:
            return f"The muscles can do it, with activations of at most {self.activation.max():.2f}."
        k, j = np.unravel_index(np.abs(self.reserve).argmax(), self.reserve.shape)
        return (
            f"The muscles cannot do it: at {self.t[k]:.2f} s the {self.coordinates[j]} lacks "
            f"{abs(self.reserve[k, j]):.3g} Nm, where the movement takes {abs(self.required[k, j]):.3g} Nm."
        )


def muscle_feasibility(arm: Arm, reference: Reference, load_mass: float = 0.0) -> Feasibility:
    """The activations that each sample of a reference takes, if the muscles are strong enough.

    load_mass: kg, in the hand. Static optimization (Anderson and Pandy 2001) takes every sample by itself: with force,
    length, velocity, passive forces and stretched tendons, but as if activations could change at once.
    """
    q, v = reference.q, reference.v
    required = inverse_dynamics(MakeTorqueArm(arm, load_mass), q, v, reference.a)
    activation, reserve = np.empty((len(q), len(arm.muscles))), np.empty_like(required)
    guess = arm.muscle_table["minimum_activation"].copy()
    for k in range(len(q)):
        activation[k], reserve[k] = static_activations(q[k], v[k], required[k], guess, arm.muscle_table, arm.path_table)
        guess = activation[k]
    return Feasibility(arm.coordinates, reference.t, activation, required, reserve)
