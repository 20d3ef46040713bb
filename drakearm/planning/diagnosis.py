"""Why there is no plan: solves again with relaxed limits and names those that are violated."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.solvers import MathematicalProgram, SnoptSolver, SolverInterface, SolverOptions

from drakearm.planning.problem import NamedConstraint, Problem

_NEGLIGIBLE = 1e-3  # violation of a limit or an equation, in its own unit, that does not count


@dataclass(frozen=True)
class Violation:
    """By how much a constraint is violated, at the time where this is worst."""

    name: str
    amount: float
    unit: str
    time: float  # s

    def __str__(self) -> str:
        return f"{self.name} by {self.amount:.3g} {self.unit}".rstrip() + f" at {self.time:.2f} s"


def violations(prog: MathematicalProgram, constraints: Sequence[NamedConstraint], x: np.ndarray) -> list[Violation]:
    """The constraints that the program's variables x violate: each name once, at its worst time, the worst first."""
    worst: dict[str, Violation] = {}
    for constraint in constraints:
        evaluator = constraint.binding.evaluator()
        value = prog.EvalBinding(constraint.binding, x)
        excess = np.maximum(evaluator.lower_bound() - value, value - evaluator.upper_bound())
        row = int(np.argmax(excess))
        amount = float(excess[row])
        found = worst.get(constraint.name)
        if amount > _NEGLIGIBLE and (found is None or amount > found.amount):
            time = float(constraint.times[row])
            worst[constraint.name] = Violation(constraint.name, amount, constraint.unit, time)
    return sorted(worst.values(), key=lambda v: -v.amount)


def explain(problem: Problem, solver: SolverInterface, failed: np.ndarray) -> str:
    """The reason why there is no plan, as part of a sentence. failed: the variables at which the solver stopped."""
    x = _relax_limits(problem, solver)
    broken = violations(problem.prog, problem.limits, x) if x is not None else []
    if broken:
        return "even the nearest movement exceeds " + _join(broken)
    broken = violations(problem.prog, problem.constraints, failed)
    if broken:
        return "the movement at which the solver stopped violates " + _join(broken)
    return "the movement at which the solver stopped violates nothing, but its costs could still fall"


def _relax_limits(problem: Problem, solver: SolverInterface) -> np.ndarray | None:
    """The variables of the movement that exceeds the limits least; None if the solver does not find one either."""
    prog = problem.prog.Clone()
    for cost in prog.GetAllCosts():
        prog.RemoveCost(cost)
    excess = prog.NewContinuousVariables(len(problem.limits), "excess")  # over each limit, relative to it
    prog.AddBoundingBoxConstraint(0.0, np.inf, excess)
    prog.AddLinearCost(np.ones(len(excess)), 0.0, excess)
    start = problem.prog.initial_guess()
    shares = []
    for limit, share in zip(problem.limits, excess, strict=True):
        prog.RemoveConstraint(limit.binding)
        bound = limit.binding.evaluator().upper_bound()[:, None]
        variables = limit.binding.variables()
        identity = np.eye(len(variables))
        rows = np.block([[identity, -bound], [-identity, -bound]])
        prog.AddLinearConstraint(
            rows,
            np.full(len(rows), -np.inf),
            np.vstack([bound, bound])[:, 0],
            np.append(variables, share),
        )
        most = np.max(np.abs(problem.prog.EvalBinding(limit.binding, start)) / bound[:, 0])
        shares.append(max(0.0, most - 1.0))  # so that the start violates only the dynamics
    options = SolverOptions()
    # Outside the limits torques and accelerations are huge: without scaling the solver takes ten times as long.
    options.SetOption(SnoptSolver.id(), "Scale option", 2)
    options.SetOption(SnoptSolver.id(), "Major iterations limit", 200)
    result = solver.Solve(prog, np.concatenate([start, shares]), options)
    return result.get_x_val()[: problem.prog.num_vars()] if result.is_success() else None


def _join(broken: Sequence[Violation]) -> str:
    names = [f"the {violation}" for violation in broken]
    return ", ".join(names[:-1]) + " and " * (len(names) > 1) + names[-1]
