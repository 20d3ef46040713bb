"""From a movement to a nonlinear program: its knots, dynamics, ends and limits, without the costs."""

import numpy as np
from pydrake.planning import DirectCollocation

from drakearm.model.motion import Motion
from drakearm.planning.movement import Movement
from drakearm.planning.problem import NamedConstraint, Problem
from drakearm.planning.skeleton import Skeleton

ROUNDING = 1e-9  # by which a posture may lie outside the joint limits, rad


def transcribe(
    skeleton: Skeleton,
    movement: Movement,
    times: np.ndarray,
    start: tuple[np.ndarray, np.ndarray],
    guess: Motion,
    *,
    arrives: bool,
) -> Problem:
    """The problem of moving from a start on, with knots at evenly spaced times (N,), s.

    start: the state (2 n_q,) and the torques (n_q,) at the first knot. guess: where the solver begins, over the same
    times. arrives: whether the last knot is at rest at the target.
    """
    step = (times[-1] - times[0]) / (len(times) - 1)
    collocation = DirectCollocation(
        skeleton.system,
        skeleton.system.CreateDefaultContext(),
        len(times),
        minimum_time_step=step,
        maximum_time_step=step,
        input_port_index=skeleton.system.GetInputPort("torque").get_index(),
        assume_non_continuous_states_are_fixed=True,
    )
    problem = Problem(collocation, skeleton, times, movement.target)
    prog = problem.prog
    for k, binding in enumerate(prog.generic_constraints()):  # so far, the collocation's own
        middle = np.full(binding.evaluator().num_constraints(), times[k] + 0.5 * step)
        problem.constraints.append(NamedConstraint("dynamics", "", middle, binding))

    ends = [(0, *start)]
    if arrives:
        rest = np.concatenate([movement.target, np.zeros(len(movement.target))])
        ends.append((len(times) - 1, rest, skeleton.gravity_torque(movement.target)))
    for knot, state, torque in ends:
        prog.AddBoundingBoxConstraint(state, state, collocation.state(knot))
        prog.AddBoundingBoxConstraint(torque, torque, collocation.input(knot))
    # A disturbed arm may start outside its limits, so they hold for what can be decided: from the second knot on.
    _add_limits(problem, movement, first=1, last=len(times) - 1 - arrives)
    shifted = guess.later(-times[0])  # the collocation's own time starts at 0
    collocation.SetInitialTrajectory(shifted.inputs, shifted.states)
    return problem


def angle_limits(skeleton: Skeleton, movement: Movement) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and highest joint angles, (n_q,) each, rad: the movement's own within those of the skeleton."""
    lower, upper = skeleton.lower, skeleton.upper
    if movement.angle_limit_deg is not None:
        own = np.deg2rad(movement.angle_limit_deg)
        lower, upper = np.maximum(lower, own[:, 0]), np.minimum(upper, own[:, 1])
    return lower, upper


def _add_limits(problem: Problem, movement: Movement, first: int, last: int) -> None:
    """Limits of the knots from first to last."""
    lower, upper = angle_limits(problem.skeleton, movement)
    knots = range(first, last + 1)
    for i, joint in enumerate(problem.coordinates):
        # A start or target on a limit may lie beyond it by a rounding.
        angles = [problem.q(k)[i] for k in knots]
        problem.prog.AddBoundingBoxConstraint(lower[i] - ROUNDING, upper[i] + ROUNDING, angles)
        speeds = [problem.v(k)[i] for k in knots]
        problem.add_limit(f"speed limit of the {joint}", "rad/s", movement.speed_limit[i], knots, speeds)
        torques = [problem.tau(k)[i] for k in knots]
        problem.add_limit(f"torque limit of the {joint}", "Nm", movement.torque_limit[i], knots, torques)
    if problem.skeleton.obstacle is not None:
        name = f"clearance of {', '.join(problem.skeleton.parts)}"
        for k in knots:
            problem.add_clearance(problem.skeleton.clearance, len(problem.skeleton.parts), movement.clearance, name, k)
