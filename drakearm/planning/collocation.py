"""Optimal control by direct collocation: costs a problem, solves it and says how that went."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.solvers import (
    IpoptSolver,
    MathematicalProgramResult,
    SnoptSolver,
    SolverInterface,
    SolverOptions,
)

from drakearm.errors import PlanningError
from drakearm.planning.cost import CostPiece
from drakearm.planning.diagnosis import explain
from drakearm.planning.problem import Problem
from drakearm.planning.transcription import Motion

_GUESS_COST = 10.0  # after scaling; tried: 3 to 100 take about as long


@dataclass(frozen=True)
class Solution:
    """A solved problem: the motion and what `Plan` tells about it."""

    motion: Motion
    solver: str
    status: str
    evaluations: int
    costs: dict[str, float]
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    tau: np.ndarray


def solve(problem: Problem, costs: Sequence[CostPiece], what: str) -> Solution:
    """The motion of least cost. Raises PlanningError, in one sentence, where there is none; what: "from a to b"."""
    prog, collocation = problem.prog, problem.collocation
    terms = [(cost.type, cost.add(problem)) for cost in costs]
    # Costs that are small beside SNOPT's first guess of the Hessian take it twenty times as long.
    problem.scale_costs([binding for _, bindings in terms for binding in bindings], _GUESS_COST)
    solver, options = _choose_solver()
    evaluations = _count_evaluations(problem)
    result = solver.Solve(prog, prog.initial_guess(), options)
    if not result.is_success():
        raise PlanningError(
            f"There is no plan {what}: {explain(problem, solver, result.get_x_val())} "
            f"({_name(solver)}: {_status(result)})."
        )
    value: dict[str, float] = {}
    for name, bindings in terms:
        added = float(np.sum(prog.EvalBindings(bindings, result.get_x_val())))
        value[name] = value.get(name, 0.0) + added / problem.cost_scale
    motion = Motion(collocation.ReconstructStateTrajectory(result), collocation.ReconstructInputTrajectory(result))
    q, v = np.split(collocation.GetStateSamples(result).T, 2, axis=1)
    return Solution(
        motion=motion.later(problem.times[0]),
        solver=_name(solver),
        status=_status(result),
        evaluations=len(evaluations),
        costs=value,
        t=problem.times,
        q=q,
        v=v,
        tau=collocation.GetInputSamples(result).T,
    )


def _count_evaluations(problem: Problem) -> list[None]:
    """A list that grows with every evaluation of the problem: Drake does not tell a solver's iterations."""
    seen: list[None] = []
    problem.prog.AddVisualizationCallback(lambda _: seen.append(None), problem.q(0))
    return seen


def _choose_solver() -> tuple[SolverInterface, SolverOptions]:
    """SNOPT, or IPOPT in a Drake that was built without it."""
    options = SolverOptions()
    options.SetOption(SnoptSolver.id(), "Major optimality tolerance", 1e-3)  # of scaled costs: four digits
    options.SetOption(SnoptSolver.id(), "Major iterations limit", 300)
    # Measured on the shipped scenarios: a third less time for the reaches, a fifth for timing, to the same costs.
    options.SetOption(SnoptSolver.id(), "QPSolver", "QN")
    options.SetOption(SnoptSolver.id(), "Hessian updates", 40)
    options.SetOption(IpoptSolver.id(), "tol", 1e-4)
    snopt = SnoptSolver()
    return (snopt if snopt.available() else IpoptSolver()), options


def _name(solver: SolverInterface) -> str:
    return solver.solver_id().name()


def _status(result: MathematicalProgramResult) -> str:
    """kInfeasibleConstraints: "infeasible constraints"."""
    return re.sub(r"(?<!^)([A-Z])", r" \1", result.get_solution_result().name[1:]).lower()
