"""Optimal control by direct collocation: adds the costs to a problem, solves it and reports how it was solved."""

import re
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
    prog, collocation = problem.prog, problem.collocation
    terms = [(cost.type, cost.add(problem)) for cost in costs]
    bindings = [binding for _, added in terms for binding in added]
    problem.scale_costs(bindings, cost_scale or guess_scale(problem, bindings))
    result, iterations = solve_newton(problem)
    name = newton_solver_name()
    if result is None:
        solver, options = _choose_solver()
        name = solver.solver_id().name()
        seen = _count_evaluations(problem)
        result = solver.Solve(prog, prog.initial_guess(), options)
        iterations += len(seen)
        if not result.is_success():
            raise PlanningError(
                f"There is no plan {what}: {explain(problem, solver, result.get_x_val())} ({name}: {_status(result)})."
            )
    motion = Motion(collocation.ReconstructStateTrajectory(result), collocation.ReconstructInputTrajectory(result))
    q, v = np.split(collocation.GetStateSamples(result).T, 2, axis=1)
    return Solution(
        motion=motion.later(problem.times[0]),
        solver=name,
        status=_status(result),
        iterations=iterations,
        costs=_values(problem, terms, result.get_x_val()),
        t=problem.times,
        q=q,
        v=v,
        tau=collocation.GetInputSamples(result).T,
    )


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
    return _GUESS_COST / of_guess if of_guess > 0.0 else 1.0


def _count_evaluations(problem: Problem) -> list[None]:
    """A list that grows by one with every evaluation of the problem: Drake does not report a solver's iterations."""
    seen: list[None] = []
    problem.prog.AddVisualizationCallback(lambda _: seen.append(None), problem.q(0))
    return seen


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
