"""Whether muscles can do a movement: static optimization at every sample, and the torque that is missing."""

from dataclasses import dataclass

import numpy as np

from drakearm.errors import TaskError
from drakearm.model import Arm, MakeTorqueArm
from drakearm.model.joint_ranges import range_problem
from drakearm.model.reference import Reference
from drakearm.model.skeleton import movement_torques
from drakearm.model.static_optimization import negligible_reserve, static_activations
from drakearm.model.weakness import weakness


@dataclass(frozen=True)
class Feasibility:
    """What a movement requires of the muscles, at times t (N,), s.

    activation: (N, n), those with the least sum of squares. required: the joint torques (N, n_q), Nm, that the movement
    takes. reserve: the part of them (N, n_q), Nm, that the muscles cannot exert. negligible: Nm, a reserve that does
    not count.
    """

    coordinates: tuple[str, ...]
    t: np.ndarray
    activation: np.ndarray
    required: np.ndarray
    reserve: np.ndarray
    negligible: float

    @property
    def feasible(self) -> bool:
        """Whether the muscles are strong and quick enough for every sample."""
        return bool(np.abs(self.reserve).max() <= self.negligible)

    @property
    def verdict(self) -> str:
        """One sentence: the largest activation, or which joint lacks how much torque, and when, see `weakness`."""
        if self.feasible:
            return f"The muscles can do it, with activations of at most {self.activation.max():.2f}."
        k, j = np.unravel_index(np.abs(self.reserve).argmax(), self.reserve.shape)
        why = weakness(self.coordinates[j], float(self.reserve[k, j]), float(self.required[k, j]))
        return f"The muscles cannot do it: at {self.t[k]:.2f} s {why}."

    @property
    def advice(self) -> str:
        """What to change if the muscles cannot do it, as one sentence."""
        missing = np.abs(self.reserve).max(axis=1) > self.negligible
        for k, where in ((0, "start"), (-1, "target")):
            if missing[k]:
                return (
                    f"More time does not help, because they cannot hold the posture at the {where}: expected another "
                    f"{where} or a smaller load."
                )
        return "Expected more time, a smaller load or a nearer target."


def muscle_feasibility(arm: Arm, reference: Reference, load_mass: float = 0.0) -> Feasibility:
    """The activations that each sample of a reference requires, and the torque that is missing.

    load_mass: kg, in the hand. Static optimization (Anderson and Pandy 2001) considers each sample on its own. It takes
    account of the force-length-velocity curves, passive forces and stretched tendons, but it lets activations change
    instantly from one sample to the next. Raises TaskError if the reference does not fit the arm, or if an angle is
    outside of the range of its joint by more than 0.15 rad.
    """
    reference.check(arm)
    problem = range_problem(arm, reference.q)
    if problem:
        raise TaskError(f"The arm {arm.name} cannot follow the reference: {problem}.")
    q, v = reference.q, reference.v
    required = movement_torques(MakeTorqueArm(arm, load_mass), q, v, reference.a)
    activation, reserve = np.empty((len(q), len(arm.muscles))), np.empty_like(required)
    guess, weighting = arm.muscle_table["minimum_activation"].copy(), np.eye(len(arm.coordinates))
    for k in range(len(q)):
        activation[k], reserve[k] = static_activations(
            q[k], v[k], required[k], guess, weighting, arm.muscle_table, arm.path_table
        )
        guess = activation[k]
    negligible = negligible_reserve(q[0], arm.muscle_table, arm.path_table)
    return Feasibility(arm.coordinates, reference.t, activation, required, reserve, negligible)
