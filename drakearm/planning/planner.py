"""Optimal control of the skeleton: from a movement to a reference."""

import time
from dataclasses import replace

import numpy as np
from pydrake.trajectories import PiecewisePolynomial
from scipy.optimize import minimize_scalar

from drakearm.errors import PlanningError
from drakearm.model import Arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import CONTROL_STEP
from drakearm.planning.collocation import solve
from drakearm.planning.guess import inverse_dynamics, minimum_jerk, smallest_detour
from drakearm.planning.movement import Movement
from drakearm.planning.request import check_request
from drakearm.planning.resample import make_reference
from drakearm.planning.result import Plan
from drakearm.planning.skeleton import Skeleton
from drakearm.planning.transcription import Motion, angle_limits, transcribe
from drakearm.planning.verification import check, verify

_TOO_SHORT = 1e9  # stands for the cost of a duration without a plan


def plan(arm: Arm, movement: Movement, load_mass: float = 0.0, obstacle: Obstacle | None = None) -> Plan:
    """The movement of least cost within the limits of joints, speeds and torques, and clear of the obstacle.

    load_mass: kg, in the hand. The movement starts at rest in equilibrium, and ends so unless its end is free: the
    torques there hold the arm against gravity, so the acceleration starts and ends at zero. Raises PlanningError, in
    one sentence, where the movement does not fit the arm or has no plan.
    """
    began = time.perf_counter()
    skeleton = Skeleton(arm, load_mass, obstacle)
    check_request(skeleton, movement)
    found = _plan(skeleton, movement) if isinstance(movement.duration, float) else _best_duration(skeleton, movement)
    return replace(found, seconds=time.perf_counter() - began)


def _plan(skeleton: Skeleton, movement: Movement) -> Plan:
    """The best movement of a fixed duration."""
    times = np.linspace(0.0, movement.duration, movement.knots)
    start = (np.concatenate([movement.start, np.zeros_like(movement.start)]), skeleton.gravity_torque(movement.start))
    guess = straight_guess(skeleton, movement, times)
    problem = transcribe(skeleton, movement, times, start, guess, arrives=movement.end == "rest")
    what = f"from {_degrees(movement.start_deg)} to {_degrees(movement.target_deg)} in {movement.duration:g} s"
    solution = solve(problem, movement.costs, what)
    verification = verify(skeleton, movement, solution.motion)
    check(verification, movement)
    return Plan(
        reference=make_reference(skeleton.plant, solution.motion.states, solution.motion.inputs, movement.hold),
        solver=solution.solver,
        status=solution.status,
        evaluations=solution.evaluations,
        seconds=0.0,
        costs=solution.costs,
        verification=verification,
        t=solution.t,
        q=solution.q,
        v=solution.v,
        tau=solution.tau,
    )


def straight_guess(skeleton: Skeleton, movement: Movement, times: np.ndarray) -> Motion:
    """The minimum-jerk movement, around the obstacle, at times (N,). Raises PlanningError where there is no way."""
    detour: np.ndarray | float = 0.0
    if skeleton.obstacle is not None:
        found = smallest_detour(
            movement.start,
            movement.target,
            angle_limits(skeleton, movement),
            lambda q: bool(skeleton.clearance(q)[0].min() >= movement.clearance),
        )
        if found is None:
            raise PlanningError(
                f"There is no way around the obstacle from {_degrees(movement.start_deg)} to "
                f"{_degrees(movement.target_deg)}: every detour within the joint limits meets it."
            )
        detour = found
    q, v, a = minimum_jerk(movement.start, movement.target, times, detour)
    states = PiecewisePolynomial.CubicHermite(times, np.hstack([q, v]).T, np.hstack([v, a]).T)
    torques = inverse_dynamics(skeleton.plant, q, v, a)
    return Motion(states, PiecewisePolynomial.FirstOrderHold(times, torques.T))


def _best_duration(skeleton: Skeleton, movement: Movement) -> Plan:
    """The plan of least cost among all durations, in whole control steps.

    The costs of a fixed duration are quadratic and quick; searching the one number left is cheaper than to let it make
    them all nonlinear.
    """
    assert isinstance(movement.duration, tuple)
    shortest, longest = movement.duration
    plans: dict[int, Plan | PlanningError] = {}

    def cost(duration: float) -> float:
        steps = round(duration / CONTROL_STEP)
        if steps not in plans:
            try:
                plans[steps] = _plan(skeleton, replace(movement, duration=round(steps * CONTROL_STEP, 6)))
            except PlanningError as error:
                plans[steps] = error
        found = plans[steps]
        return _TOO_SHORT * (2.0 - duration / longest) if isinstance(found, PlanningError) else _total(found)

    for duration in (shortest, longest):
        cost(duration)
    minimize_scalar(cost, bounds=(shortest, longest), method="bounded", options={"xatol": 0.5 * CONTROL_STEP})
    succeeded = [found for found in plans.values() if isinstance(found, Plan)]
    if not succeeded:
        failed = plans[max(plans)]
        assert isinstance(failed, PlanningError)
        raise failed
    return min(succeeded, key=_total)


def _total(found: Plan) -> float:
    return sum(found.costs.values())


def _degrees(angles: tuple[float, ...]) -> str:
    return "(" + ", ".join(f"{angle:g}" for angle in angles) + ") deg"
