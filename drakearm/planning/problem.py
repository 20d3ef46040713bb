"""The movement as a nonlinear program: knots with their variables, constraints with names."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from pydrake.planning import DirectCollocation
from pydrake.solvers import Binding, Constraint, MathematicalProgram
from pydrake.symbolic import Variable

from drakearm.errors import PlanningError


@dataclass(frozen=True)
class NamedConstraint:
    """A constraint as a user knows it: its rows happen at `times` (s), its violation has a unit."""

    name: str
    unit: str
    times: np.ndarray
    binding: Binding[Constraint]


@dataclass(frozen=True)
class Problem:
    """A collocation with knots at fixed times: what costs and constraints are added to.

    constraints: those that a solver may fail to meet. limits: those that a user could raise.
    """

    collocation: DirectCollocation
    coordinates: tuple[str, ...]
    times: np.ndarray  # of the knots, s
    target: np.ndarray  # (n_q,) rad
    constraints: list[NamedConstraint] = field(default_factory=list)
    limits: list[NamedConstraint] = field(default_factory=list)

    @property
    def prog(self) -> MathematicalProgram:
        return self.collocation.prog()

    @property
    def shares(self) -> np.ndarray:
        """The time (s) that each knot stands for in an integral: the trapezoidal rule."""
        steps = np.diff(self.times)
        return 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))

    def q(self, knot: int) -> np.ndarray:
        return self.collocation.state(knot)[: len(self.coordinates)]

    def v(self, knot: int) -> np.ndarray:
        return self.collocation.state(knot)[len(self.coordinates) :]

    def tau(self, knot: int) -> np.ndarray:
        return self.collocation.input(knot)

    def add_limit(self, name: str, unit: str, limit: float, variables: Sequence[Variable]) -> None:
        """Keeps one variable a knot within +-limit."""
        binding = self.prog.AddBoundingBoxConstraint(-limit, limit, np.array(variables))
        binding.evaluator().set_description(name)
        self.limits.append(NamedConstraint(name, unit, self.times, binding))

    def coordinate(self, name: str) -> int:
        """The index of a coordinate. Raises PlanningError for a name that the arm does not have."""
        if name not in self.coordinates:
            raise PlanningError(f"A cost names the joint {name!r}: expected one of {', '.join(self.coordinates)}.")
        return self.coordinates.index(name)

    def weights(self, weight: float | Sequence[float]) -> np.ndarray:
        """Weights (n_q,) from one for all coordinates or one for each.

        Raises PlanningError for another number of them.
        """
        weights = np.atleast_1d(np.asarray(weight, dtype=float))
        if len(weights) not in (1, len(self.coordinates)):
            raise PlanningError(
                f"A cost has {len(weights)} weights: expected one, or one for each of {', '.join(self.coordinates)}."
            )
        return np.broadcast_to(weights, len(self.coordinates))
