"""From a movement to a nonlinear program: its knots, dynamics, ends and limits, without the costs."""

import numpy as np
from pydrake.planning import DirectCollocation

from drakearm.model.motion import Motion
from drakearm.planning.guess import straight_guess
from drakearm.planning.movement import Movement
from drakearm.planning.planning_model import ROUNDING, PlanningModel
from drakearm.planning.problem import NamedConstraint, Problem


def transcribe_movement(model: PlanningModel, movement: Movement) -> Problem:
    """The problem of a whole movement of fixed duration, from rest in equilibrium at its start."""
    assert isinstance(movement.duration, float)
    times = np.linspace(0.0, movement.duration, movement.knots)
    start = (np.concatenate([movement.start, np.zeros_like(movement.start)]), model.gravity_torque(movement.start))
    guess = straight_guess(model, movement, times)
    return transcribe(model, movement, times, start, guess, arrives=movement.end == "rest")


def transcribe(
    model: PlanningModel,
    movement: Movement,
    times: np.ndarray,
    start: tuple[np.ndarray, np.ndarray],
    guess: Motion,
    *,
    arrives: bool,
) -> Problem:
    """The problem of a movement from any start, with knots at evenly spaced times (N,), s.

    start: the state (2 n_q,) and the torques (n_q,) at the first knot. guess: the solver's initial guess, over the same
    times. arrives: whether the last knot must be at rest at the target.
    """
    step = (times[-1] - times[0]) / (len(times) - 1)
    collocation = DirectCollocation(
        model.system,
        model.system.CreateDefaultContext(),
        len(times),
        minimum_time_step=step,
        maximum_time_step=step,
        input_port_index=model.system.GetInputPort("torque").get_index(),
        assume_non_continuous_states_are_fixed=True,
    )
    problem = Problem(collocation, model, times, movement.target)
    prog = problem.prog
    for k, binding in enumerate(prog.generic_constraints()):  # at this point only the collocation's own
        middle = np.full(binding.evaluator().num_constraints(), times[k] + 0.5 * step)
        problem.constraints.append(NamedConstraint("dynamics", "", middle, binding))

    ends = [(0, *start)]
    if arrives:
        rest = np.concatenate([movement.target, np.zeros(len(movement.target))])
        ends.append((len(times) - 1, rest, model.gravity_torque(movement.target)))
    for knot, state, torque in ends:
        prog.AddBoundingBoxConstraint(state, state, collocation.state(knot))
        prog.AddBoundingBoxConstraint(torque, torque, collocation.input(knot))
    # A disturbed arm may start outside its limits. So they hold from the second knot on, where the plan can keep them.
    _add_limits(problem, movement, first=1, last=len(times) - 1 - arrives)
    shifted = guess.later(-times[0])  # the collocation's own time starts at 0
    collocation.SetInitialTrajectory(shifted.inputs, shifted.states)
    return problem


def _add_limits(problem: Problem, movement: Movement, first: int, last: int) -> None:
    """Adds the limits of the knots from first to last, both included."""
    model = problem.model
    lower, upper = model.angle_limits(movement.angle_limit_deg)
    knots = range(first, last + 1)
    for i, joint in enumerate(model.coordinates):
        angles = [problem.q(k)[i] for k in knots]
        problem.prog.AddBoundingBoxConstraint(lower[i] - ROUNDING, upper[i] + ROUNDING, angles)
        speeds = [problem.v(k)[i] for k in knots]
        problem.add_limit(f"speed limit of the {joint}", "rad/s", movement.speed_limit[i], knots, speeds)
        torques = [problem.tau(k)[i] for k in knots]
        problem.add_limit(f"torque limit of the {joint}", "Nm", movement.torque_limit[i], knots, torques)
    if model.obstacle is not None:
        name = f"clearance of {', '.join(model.parts)}"
        for k in knots:
            problem.add_clearance(model.clearance, len(model.parts), movement.clearance, name, k)
