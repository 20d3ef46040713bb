"""The movement as a nonlinear program: knots with variables, constraints with names, costs with a common scale."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from pydrake.autodiffutils import ExtractGradient, ExtractValue, InitializeAutoDiff
from pydrake.planning import DirectCollocation
from pydrake.solvers import Binding, Constraint, MathematicalProgram, QuadraticCost
from pydrake.solvers import Cost as DrakeCost
from pydrake.symbolic import Variable

from drakearm.errors import PlanningError, shown
from drakearm.planning.planning_model import PlanningModel

Differentiable = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  # x (n,) to values (m,) and Jacobian (m, n)


@dataclass(frozen=True)
class NamedConstraint:
    """A constraint with the name and unit that messages use. times: s, one for each of its rows."""

    name: str
    unit: str
    times: np.ndarray
    binding: Binding[Constraint]


@dataclass(frozen=True)
class Nonlinear:
    """A differentiable function of some variables: its square is a cost, or its values are at least `least`."""

    function: Differentiable
    variables: np.ndarray
    weight: float = 0.0  # of the sum of its values' squares
    least: float | None = None


@dataclass
class Problem:
    """A collocation with knots at fixed times, to which costs and constraints are added.

    constraints: those that a solver may fail to satisfy. limits: those that a user can change.
    """

    collocation: DirectCollocation
    model: PlanningModel
    times: np.ndarray  # of the knots, s from the start of the movement
    target: np.ndarray  # (n_q,) rad
    constraints: list[NamedConstraint] = field(default_factory=list)
    limits: list[NamedConstraint] = field(default_factory=list)
    nonlinear: list[Nonlinear] = field(default_factory=list)  # squares and inequalities, for `solve_newton`
    only_squares: bool = True  # whether every cost is a sum of squares
    cost_scale: float = 1.0  # factor on all costs, only inside the solver

    @property
    def prog(self) -> MathematicalProgram:
        return self.collocation.prog()

    @property
    def coordinates(self) -> tuple[str, ...]:
        return self.model.coordinates

    @property
    def shares(self) -> np.ndarray:
        """The time (s) by which each knot is multiplied in an integral: the trapezoidal rule."""
        steps = np.diff(self.times)
        return 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))

    def q(self, knot: int) -> np.ndarray:
        return self.collocation.state(knot)[: len(self.coordinates)]

    def v(self, knot: int) -> np.ndarray:
        return self.collocation.state(knot)[len(self.coordinates) :]

    def tau(self, knot: int) -> np.ndarray:
        return self.collocation.input(knot)

    def add_cost(self, function: Differentiable, variables: np.ndarray) -> Binding[DrakeCost]:
        """Adds a cost of any form. function: from variables (n,) to the cost's value (1,) and its gradient (1, n).

        For sums of squares use `add_squares`, so that they can be solved with `solve_newton`.
        """
        self.only_squares = False
        return self._add_function(function, variables)

    def add_squares(self, function: Differentiable, weight: float, variables: np.ndarray) -> Binding[DrakeCost]:
        """Adds weight times the sum of squares of a function's values.

        function: from variables (n,) to values (m,) and their Jacobian (m, n).
        """

        def cost(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            value, jacobian = function(x)
            return np.array([weight * value @ value]), 2.0 * weight * (value @ jacobian)[None, :]

        self.nonlinear.append(Nonlinear(function, variables, weight=weight))
        return self._add_function(cost, variables)

    def _add_function(self, function: Differentiable, variables: np.ndarray) -> Binding[DrakeCost]:
        def scaled(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            value, gradient = function(x)
            return self.cost_scale * value, self.cost_scale * gradient

        return self.prog.AddCost(lambda x: _evaluate(scaled, x)[0], variables)

    def add_limit(
        self, name: str, unit: str, limit: float, knots: Sequence[int], variables: Sequence[Variable]
    ) -> None:
        """Keeps one variable of each of these knots between -limit and limit."""
        binding = self.prog.AddBoundingBoxConstraint(-limit, limit, np.array(variables))
        binding.evaluator().set_description(name)
        self.limits.append(NamedConstraint(name, unit, self.times[list(knots)], binding))

    def add_clearance(self, function: Differentiable, rows: int, least: float, name: str, knot: int) -> None:
        """Keeps all values of function(q), m, above `least` at a knot and in the middle of the interval before it.

        In the middle the collocation's cubic splines have q = (q_0 + q_1) / 2 + h (v_0 - v_1) / 8. rows: the number of
        values.
        """
        n_q, step = len(self.coordinates), self.times[knot] - self.times[knot - 1]
        middle = np.kron([0.5, 0.125 * step, 0.5, -0.125 * step], np.eye(n_q))
        states = np.concatenate([self.collocation.state(knot - 1), self.collocation.state(knot)])
        places = [(np.eye(n_q), self.q(knot), self.times[knot]), (middle, states, self.times[knot] - 0.5 * step)]
        for matrix, variables, time in places:

            def clearance(x: np.ndarray, matrix: np.ndarray = matrix) -> tuple[np.ndarray, np.ndarray]:
                value, jacobian = function(matrix @ x)
                return value, jacobian @ matrix

            bounds = np.full(rows, least), np.full(rows, np.inf)
            binding = self.prog.AddConstraint(lambda x, f=clearance: _evaluate(f, x), *bounds, variables)
            self.constraints.append(NamedConstraint(name, "m", np.full(rows, time), binding))
            self.nonlinear.append(Nonlinear(clearance, variables, least=least))

    def scale_costs(self, bindings: Sequence[Binding], scale: float) -> None:
        """Multiplies all costs by a scale, which does not change the solution. bindings: all costs of the problem."""
        self.cost_scale = scale
        for binding in bindings:
            cost = binding.evaluator()
            if isinstance(cost, QuadraticCost):
                cost.UpdateCoefficients(scale * cost.Q(), scale * cost.b(), scale * cost.c())

    def coordinate(self, name: str) -> int:
        """The index of a coordinate. Raises PlanningError for a name that the arm does not have."""
        if name not in self.coordinates:
            raise PlanningError(f"A cost names the joint {shown(name)}: expected one of {', '.join(self.coordinates)}.")
        return self.coordinates.index(name)

    def weights(self, weight: float | Sequence[float]) -> np.ndarray:
        """Weights (n_q,), from one for all coordinates or one for each. Raises PlanningError for another number."""
        return self.per_coordinate(weight, "weights")

    def per_coordinate(self, values: float | Sequence[float] | np.ndarray, what: str) -> np.ndarray:
        """Values (n_q,), from one for all coordinates or one for each. Raises PlanningError for another number.

        what: names the values in the error, as "weights".
        """
        array = np.atleast_1d(np.asarray(values, dtype=float))
        if len(array) not in (1, len(self.coordinates)):
            raise PlanningError(
                f"A cost has {len(array)} {what}: expected one, or one for each of {', '.join(self.coordinates)}."
            )
        return np.broadcast_to(array, len(self.coordinates))


def _evaluate(function: Differentiable, x: np.ndarray) -> np.ndarray:
    """The function's values at x, in double or in AutoDiffXd, where its Jacobian multiplies the derivatives of x."""
    if x.dtype != object:
        return function(x)[0]
    value, jacobian = function(ExtractValue(x).ravel())
    return InitializeAutoDiff(value, jacobian @ ExtractGradient(x)).ravel()
