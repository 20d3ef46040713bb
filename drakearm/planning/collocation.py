"""Optimal control of the skeleton by direct collocation: from a movement to a reference."""

import re
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.planning import DirectCollocation
from pydrake.solvers import (
    Binding,
    IpoptSolver,
    MathematicalProgramResult,
    QuadraticCost,
    SnoptSolver,
    SolverInterface,
    SolverOptions,
)
from pydrake.systems.framework import Context, InputPortIndex, System
from pydrake.trajectories import PiecewisePolynomial

from drakearm.diagrams import MakeTorqueArm
from drakearm.errors import PlanningError
from drakearm.model import Arm
from drakearm.model.dynamics import read_dynamics
from drakearm.model.reference import Reference
from drakearm.planning.diagnosis import explain
from drakearm.planning.guess import gravity_torque, inverse_dynamics, minimum_jerk
from drakearm.planning.movement import Movement
from drakearm.planning.problem import NamedConstraint, Problem
from drakearm.planning.resample import make_reference
from drakearm.systems import CompiledSkeleton

_GUESS_COST = 10.0  # after scaling; tried: 3 to 100 take about as long
_ROUNDING = 1e-9  # by which a posture may lie outside the joint limits, rad


@dataclass(frozen=True)
class Plan:
    """An optimal movement: its reference, how it was found, and its knots (N of them)."""

    reference: Reference
    solver: str
    status: str
    seconds: float  # to plan, all in all
    costs: dict[str, float]  # what each type of cost contributes
    t: np.ndarray  # (N,) s
    q: np.ndarray  # (N, n_q) rad
    v: np.ndarray  # (N, n_q) rad/s
    tau: np.ndarray  # (N, n_q) Nm, linear between the knots


def plan(arm: Arm, movement: Movement, load_mass: float = 0.0) -> Plan:
    """The movement of least cost within the limits of joints, speeds and torques.

    load_mass: kg, in the hand. The movement starts and ends at rest in equilibrium: the torques
    there hold the arm against gravity, so the acceleration starts and ends at zero. Raises
    PlanningError, in one sentence, where the movement does not fit the arm or has no plan.
    """
    began = time.perf_counter()
    _check_lengths(arm, movement)
    # The problem's bounds are the torque limit: motors that clamp too would hide what exceeds it.
    plant = MakeTorqueArm(arm, load_mass, torque_limit=np.full(len(arm.coordinates), np.inf))
    _check_rest(plant, arm, movement)

    problem = _transcribe(plant, arm, movement)
    terms = [(cost.type, cost.add(problem)) for cost in movement.costs]
    scale = _scale_costs(problem, [binding for _, bindings in terms for binding in bindings])
    solver, options = _choose_solver()
    result = solver.Solve(problem.prog, problem.prog.initial_guess(), options)
    if not result.is_success():
        raise PlanningError(
            f"There is no plan from {_degrees(movement.start_deg)} to "
            f"{_degrees(movement.target_deg)} in {movement.duration:g} s: "
            f"{explain(problem, solver, result.get_x_val())} ({_name(solver)}: {_status(result)})."
        )

    costs: dict[str, float] = {}
    for name, bindings in terms:
        value = float(np.sum(problem.prog.EvalBindings(bindings, result.get_x_val())))
        costs[name] = costs.get(name, 0.0) + value / scale
    collocation = problem.collocation
    q, v = np.split(collocation.GetStateSamples(result).T, 2, axis=1)
    reference = make_reference(
        plant,
        collocation.ReconstructStateTrajectory(result),
        collocation.ReconstructInputTrajectory(result),
        movement.hold,
    )
    return Plan(
        reference=reference,
        solver=_name(solver),
        status=_status(result),
        seconds=time.perf_counter() - began,
        costs=costs,
        t=collocation.GetSampleTimes(result),
        q=q,
        v=v,
        tau=collocation.GetInputSamples(result).T,
    )


def _check_lengths(arm: Arm, movement: Movement) -> None:
    for name in ("start_deg", "target_deg", "speed_limit", "torque_limit"):
        values = getattr(movement, name)
        if len(values) != len(arm.coordinates):
            raise PlanningError(
                f"The movement's {name} has {len(values)} values: expected "
                f"{len(arm.coordinates)}, for {', '.join(arm.coordinates)}."
            )


def _check_rest(plant: MultibodyPlant, arm: Arm, movement: Movement) -> None:
    """The arm must be able to rest where the movement starts and where it ends."""
    lower, upper = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
    for name, q in (("start", movement.start), ("target", movement.target)):
        torque = gravity_torque(plant, q)
        for i, joint in enumerate(arm.coordinates):
            if not lower[i] - _ROUNDING <= q[i] <= upper[i] + _ROUNDING:
                low, high = np.rad2deg([lower[i], upper[i]])
                raise PlanningError(
                    f"The {name} has the {joint} at {np.rad2deg(q[i]):.4g} deg: expected an angle "
                    f"within its joint limits, {low:.4g} to {high:.4g} deg."
                )
            if abs(torque[i]) > movement.torque_limit[i]:
                raise PlanningError(
                    f"To rest at the {name}, gravity asks {abs(torque[i]):.3g} Nm of the {joint}: "
                    f"expected at most the torque limit of the {joint}, "
                    f"{movement.torque_limit[i]:.3g} Nm."
                )


def _system_to_plan_on(plant: MultibodyPlant) -> tuple[System, Context, InputPortIndex]:
    """What stands for the arm in the collocation: continuous, of state (q, v) and input tau.

    The plant itself would give the same optimum but carrying derivatives through it takes six times as long.
    """
    system = CompiledSkeleton(read_dynamics(plant))
    return system, system.CreateDefaultContext(), system.GetInputPort("torque").get_index()


def _transcribe(plant: MultibodyPlant, arm: Arm, movement: Movement) -> Problem:
    """The movement's knots, dynamics, ends and limits, without costs; the initial guess is set."""
    system, context, port = _system_to_plan_on(plant)
    step = movement.duration / (movement.knots - 1)
    collocation = DirectCollocation(
        system,
        context,
        movement.knots,
        minimum_time_step=step,
        maximum_time_step=step,
        input_port_index=port,
        assume_non_continuous_states_are_fixed=True,
    )
    times = np.linspace(0.0, movement.duration, movement.knots)
    problem = Problem(collocation, arm.coordinates, times, movement.target)
    prog = problem.prog
    for k, binding in enumerate(prog.generic_constraints()):  # so far, the collocation's own
        middle = np.full(binding.evaluator().num_constraints(), times[k] + 0.5 * step)
        problem.constraints.append(NamedConstraint("dynamics", "", middle, binding))

    still = np.zeros(len(arm.coordinates))
    for knot, end in ((0, movement.start), (movement.knots - 1, movement.target)):
        state = np.concatenate([end, still])
        prog.AddBoundingBoxConstraint(state, state, collocation.state(knot))
        torque = gravity_torque(plant, end)
        prog.AddBoundingBoxConstraint(torque, torque, collocation.input(knot))
    _add_limits(problem, plant, movement)

    q, v, a = minimum_jerk(movement.start, movement.target, times)
    states = PiecewisePolynomial.CubicHermite(times, np.hstack([q, v]).T, np.hstack([v, a]).T)
    torques = inverse_dynamics(plant, q, v, a)
    inputs = PiecewisePolynomial.FirstOrderHold(times, torques.T)
    collocation.SetInitialTrajectory(inputs, states)
    return problem


def _add_limits(problem: Problem, plant: MultibodyPlant, movement: Movement) -> None:
    lower, upper = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
    knots = range(len(problem.times))
    for i, joint in enumerate(problem.coordinates):
        angles = [problem.q(k)[i] for k in knots]
        # A start or target on a limit may lie beyond it by a rounding.
        problem.prog.AddBoundingBoxConstraint(lower[i] - _ROUNDING, upper[i] + _ROUNDING, angles)
        speeds = [problem.v(k)[i] for k in knots]
        problem.add_limit(f"speed limit of the {joint}", "rad/s", movement.speed_limit[i], speeds)
        torques = [problem.tau(k)[i] for k in knots]
        problem.add_limit(f"torque limit of the {joint}", "Nm", movement.torque_limit[i], torques)


def _scale_costs(problem: Problem, bindings: Sequence[Binding[QuadraticCost]]) -> float:
    """Multiplies all costs by the factor returned, so that only the ratio of the weights matters.

    Costs that are small beside SNOPT's first guess of the Hessian take it twenty times as long.
    """
    guess = problem.prog.initial_guess()
    total = float(np.sum(problem.prog.EvalBindings(bindings, guess)))
    scale = _GUESS_COST / total if total > 0.0 else 1.0
    for binding in bindings:
        cost = binding.evaluator()
        cost.UpdateCoefficients(scale * cost.Q(), scale * cost.b(), scale * cost.c())
    return scale


def _degrees(angles: tuple[float, ...]) -> str:
    return "(" + ", ".join(f"{angle:g}" for angle in angles) + ") deg"


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
