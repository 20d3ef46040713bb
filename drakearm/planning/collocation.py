"""Optimal control by direct collocation: adds the costs to a problem, solves it and reports how it was solved."""

import re
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.solvers import (
    Binding,
    IpoptSolver,
    MathematicalProgramResult,
    SnoptSolver,
    SolverInterface,
    SolverOptions,
)

from drakearm.errors import PlanningError
from drakearm.model.motion import Motion
from drakearm.planning.costs import CostPiece
from drakearm.planning.diagnosis import explain
from drakearm.planning.newton import newton_solver_name, solve_newton
from drakearm.planning.problem import Problem

_GUESS_COST = 10.0  # of the initial guess, after scaling; values from 3 to 100 take about as long
_LONGEST = 4.0  # s of processor time that the nonlinear solver may take; it usually takes less than one


@dataclass(frozen=True)
class Solution:
    """A solved problem: the motion, and the fields that `Plan` takes from it."""

    motion: Motion
    solver: str
    status: str
    iterations: int
    costs: dict[str, float]
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    tau: np.ndarray


def solve(problem: Problem, costs: Sequence[CostPiece], what: str, cost_scale: float | None = None) -> Solution:
    """The motion of least cost. Raises PlanningError, with one sentence, if there is none.

    what: continues "There is no plan" in that sentence, for example "from a to b". cost_scale: factor by which the
    solver's costs are multiplied; by default that of `guess_scale`.
    """
    collocation = problem.collocation
    terms = [(cost.type, cost.add(problem)) for cost in costs]
    bindings = [binding for _, added in terms for binding in added]
    problem.scale_costs(bindings, cost_scale or guess_scale(problem, bindings))
    result, iterations = solve_newton(problem)
    name = newton_solver_name()
    if result is None:
        result, name, evaluations = _solve_nonlinear(problem, what)
        iterations += evaluations
    values = _values(problem, terms, result.get_x_val())
    if not np.isfinite([*result.get_x_val(), *values.values()]).all():
        raise PlanningError(f"There is no plan {what}: the solver {name} found numbers that are not finite.")
    motion = Motion(collocation.ReconstructStateTrajectory(result), collocation.ReconstructInputTrajectory(result))
    q, v = np.split(collocation.GetStateSamples(result).T, 2, axis=1)
    return Solution(
        motion=motion.later(problem.times[0]),
        solver=name,
        status=_status(result),
        iterations=iterations,
        costs=values,
        t=problem.times,
        q=q,
        v=v,
        tau=collocation.GetInputSamples(result).T,
    )


def _solve_nonlinear(problem: Problem, what: str) -> tuple[MathematicalProgramResult, str, int]:
    """The solution, the solver's name and its evaluations. Raises PlanningError if there is none."""
    solver, options = _choose_solver()
    name = solver.solver_id().name()
    clock = _Clock(problem)
    try:
        result = solver.Solve(problem.prog, problem.prog.initial_guess(), options)
        if result.is_success():
            return result, name, clock.evaluations
        clock.start()
        reason = f"{explain(problem, solver, result.get_x_val())} ({name}: {_status(result)})"
    except (RuntimeError, TimeoutError) as error:  # a solver may turn the clock's error into its own
        if not clock.is_over:
            raise PlanningError(f"There is no plan {what}: {name} stopped, {str(error)[:100]}.") from error
        reason = f"{name} found none in {_LONGEST:g} s; expected fewer knots, or limits and costs that are easier"
    raise PlanningError(f"There is no plan {what}: {reason}.")


class _Clock:
    """Counts the evaluations of a problem, and stops its solver with a TimeoutError when the time is over.

    Drake does not report a solver's iterations, and not every solver keeps a limit on its time.
    """

    def __init__(self, problem: Problem):
        self.evaluations = 0
        self._end = np.inf
        problem.prog.AddVisualizationCallback(self._evaluated, problem.q(0))

    def start(self) -> None:
        """Gives the solver the whole time, again."""
        self._end = time.thread_time() + _LONGEST

    @property
    def is_over(self) -> bool:
        return time.thread_time() > self._end

    def _evaluated(self, _: np.ndarray) -> None:
        self.evaluations += 1
        if self.evaluations == 2:  # during the first evaluation, functions may be compiled
            self.start()
        if self.is_over:
            raise TimeoutError


def evaluate(problem: Problem, costs: Sequence[CostPiece]) -> dict[str, float]:
    """What each type of cost contributes at the problem's initial guess."""
    return _values(problem, [(cost.type, cost.add(problem)) for cost in costs], problem.prog.initial_guess())


def _values(problem: Problem, terms: list[tuple[str, list[Binding]]], x: np.ndarray) -> dict[str, float]:
    values: dict[str, float] = {}
    for name, bindings in terms:
        added = float(np.sum(problem.prog.EvalBindings(bindings, x)))
        values[name] = values.get(name, 0.0) + added / problem.cost_scale
    return values


def guess_scale(problem: Problem, bindings: Sequence[Binding]) -> float:
    """The factor on all costs that gives the initial guess a total cost of a size that suits the solver.

    SNOPT takes twenty times as long with costs that are small in comparison with its first guess of the Hessian.
    """
    of_guess = float(np.sum(problem.prog.EvalBindings(bindings, problem.prog.initial_guess())))
    return _GUESS_COST / of_guess if 1e-30 < of_guess < 1e30 else 1.0


def _choose_solver() -> tuple[SolverInterface, SolverOptions]:
    """SNOPT, or IPOPT if Drake was built without SNOPT."""
    options = SolverOptions()
    options.SetOption(SnoptSolver.id(), "Major optimality tolerance", 1e-3)  # of scaled costs: four digits
    options.SetOption(SnoptSolver.id(), "Major iterations limit", 300)
    # Measured on the shipped scenarios: the same costs, in a third less time for reaching and a fifth for timing.
    options.SetOption(SnoptSolver.id(), "QPSolver", "QN")
    options.SetOption(SnoptSolver.id(), "Hessian updates", 40)
    options.SetOption(IpoptSolver.id(), "tol", 1e-4)
    snopt = SnoptSolver()
    return (snopt if snopt.available() else IpoptSolver()), options


def _status(result: MathematicalProgramResult) -> str:
    """kInfeasibleConstraints: "infeasible constraints"."""
    return re.sub(r"(?<!^)([A-Z])", r" \1", result.get_solution_result().name[1:]).lower()
