"""The Gauss-Newton method: sequential quadratic programming for problems whose costs are sums of squares.

SNOPT has to learn the curvature of the costs step by step. Here it is known: quadratic costs are used as they are, and
of the square of a function the function is linearized. Constraints are linearized too, so each iteration is a convex
quadratic program. Most movements take four iterations. SNOPT takes thirty evaluations, each of ten times the work.
"""

import numpy as np
from pydrake.solvers import Binding, ClarabelSolver, LinearConstraint, MathematicalProgramResult, QuadraticCost

from drakearm.planning.defects import defects
from drakearm.planning.problem import Nonlinear, Problem

ITERATIONS = 40
_SETTLED = 1e-4  # rad, rad/s, Nm: largest change in the last iteration
_FEASIBLE = 1e-5  # largest defect (rad/s, rad/s^2) and largest lack of clearance (m)


def newton_solver_name() -> str:
    """The method and the solver of its quadratic programs, as plans report them."""
    return f"Gauss-Newton ({ClarabelSolver.id().name()})"


def solve_newton(problem: Problem) -> tuple[MathematicalProgramResult | None, int]:
    """The solution, starting at the problem's guess, and the number of iterations; None if these do not converge.

    Steps are never shortened. If they do not converge, or if a cost is not a sum of squares, another solver is needed.
    """
    if not (problem.only_squares and ClarabelSolver().available()):
        return None, 0
    convex = problem.prog.Clone()
    for binding in convex.generic_constraints():
        convex.RemoveConstraint(binding)
    for generic in convex.generic_costs():
        convex.RemoveCost(generic)
    variables = [np.concatenate([problem.collocation.state(k), problem.tau(k)]) for k in range(len(problem.times))]
    index = np.array([problem.prog.FindDecisionVariableIndices(knot) for knot in variables])
    motion = _LinearMotion(problem, index)
    rows = np.zeros((motion.rows, index.size))
    dynamics = convex.AddLinearEqualityConstraint(rows, np.zeros(motion.rows), np.concatenate(variables))
    linear = [_Linear(problem, term, convex) for term in problem.nonlinear]

    x = problem.prog.initial_guess()
    defect, jacobian = motion(x)
    solver = ClarabelSolver()
    for iteration in range(1, ITERATIONS + 1):
        dynamics.evaluator().UpdateCoefficients(jacobian, jacobian @ x[index].ravel() - defect)
        for term in linear:
            term.update(x)
        try:
            result = solver.Solve(convex)
        except RuntimeError:  # weights of very different sizes: by rounding errors, a cost is not convex
            return None, iteration
        if not (result.is_success() and np.isfinite(result.get_x_val()).all()):
            return None, iteration
        step = np.abs(result.get_x_val()[index] - x[index]).max()
        x = result.get_x_val()
        defect, jacobian = motion(x)
        if step < _SETTLED and np.abs(defect).max() < _FEASIBLE and all(t.missed(x) < _FEASIBLE for t in linear):
            return result, iteration
    return None, ITERATIONS


class _LinearMotion:
    """The defects (rows,) and their Jacobian (rows, 3 n_q N) by all knots' q, v and tau."""

    def __init__(self, problem: Problem, index: np.ndarray):
        """index: (N, 3 n_q), places of the knots' variables in x."""
        self._dynamics, self._index = problem.model.dynamics, index
        self._step = problem.times[1] - problem.times[0]
        n_knots, n_z = index.shape
        n_x = 2 * n_z // 3
        self.rows = (n_knots - 1) * n_x
        interval, row, column = np.meshgrid(range(n_knots - 1), range(n_x), range(2 * n_z), indexing="ij")
        self._places = (interval * n_x + row).ravel(), (interval * n_z + column).ravel()

    def __call__(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        defect, blocks = defects(x[self._index], self._step, self._dynamics)
        jacobian = np.zeros((self.rows, self._index.size))
        jacobian[self._places] = blocks.ravel()
        return defect.ravel(), jacobian


class _Linear:
    """A nonlinear term, linearized in the convex program."""

    def __init__(self, problem: Problem, term: Nonlinear, convex):
        self._term, self._scale = term, problem.cost_scale
        self._index = problem.prog.FindDecisionVariableIndices(term.variables)
        n = len(term.variables)
        self._cost: Binding[QuadraticCost] | None = None
        self._constraint: Binding[LinearConstraint] | None = None
        if term.least is None:
            self._cost = convex.AddQuadraticCost(np.zeros((n, n)), np.zeros(n), term.variables, is_convex=True)
        else:
            value, jacobian = term.function(problem.prog.initial_guess()[self._index])
            bounds = np.full(len(value), -np.inf), np.full(len(value), np.inf)
            self._constraint = convex.AddLinearConstraint(jacobian, *bounds, term.variables)

    def update(self, x: np.ndarray) -> None:
        at = x[self._index]
        value, jacobian = self._term.function(at)
        if self._cost is not None:
            weight = 2.0 * self._scale * self._term.weight
            residual = value - jacobian @ at
            self._cost.evaluator().UpdateCoefficients(
                weight * jacobian.T @ jacobian, weight * jacobian.T @ residual, is_convex=True
            )
        elif self._constraint is not None:
            least = self._term.least - value + jacobian @ at
            self._constraint.evaluator().UpdateCoefficients(jacobian, least, np.full(len(value), np.inf))

    def missed(self, x: np.ndarray) -> float:
        """By how much the inequality is violated, in its own unit."""
        if self._term.least is None:
            return 0.0
        return float(np.max(self._term.least - self._term.function(x[self._index])[0]))
