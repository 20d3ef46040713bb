"""Optimal control of the skeleton: from a movement to a reference."""

import time
from dataclasses import replace

import numpy as np
from pydrake.trajectories import PiecewisePolynomial
from scipy.optimize import minimize_scalar

from drakearm.diagrams import MakeMpcLoop
from drakearm.errors import PlanningError
from drakearm.model import Arm
from drakearm.model.motion import Motion
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import CONTROL_STEP
from drakearm.planning.collocation import solve
from drakearm.planning.guess import transcribe_movement
from drakearm.planning.movement import Movement, in_degrees
from drakearm.planning.receding_horizon import RecedingHorizon
from drakearm.planning.request import check_request
from drakearm.planning.resample import make_reference
from drakearm.planning.result import Plan
from drakearm.planning.skeleton import Skeleton
from drakearm.planning.verification import check, verify

_TOO_SHORT = 1e9  # stands for the cost of a duration without a plan


def plan(
    arm: Arm,
    movement: Movement,
    load_mass: float = 0.0,
    obstacle: Obstacle | None = None,
    horizon: float | None = None,
) -> Plan:
    """The movement of least cost within the limits of joints, speeds and torques, and clear of the obstacle.

    load_mass: kg, in the hand. The movement starts at rest in equilibrium, and ends so unless its end is free: the
    torques there hold the arm against gravity, so the acceleration starts and ends at zero. Raises PlanningError, in
    one sentence, where the movement does not fit the arm or has no plan.

    horizon: s, plans as Denizdurduran et al. 2022 do: again and again, so far ahead, from where the arm has come to
    (see `RecedingHorizon`). The plan is then what the arm does; its knots are the control steps.
    """
    began = time.perf_counter()
    skeleton = Skeleton(arm, load_mass, obstacle)
    check_request(skeleton, movement)
    if horizon is not None:
        found = _recede(skeleton, movement, load_mass, horizon)
    elif isinstance(movement.duration, tuple):
        found = _best_duration(skeleton, movement)
    else:
        found = _plan(skeleton, movement)
    return replace(found, seconds=time.perf_counter() - began)


def _plan(skeleton: Skeleton, movement: Movement) -> Plan:
    """The best movement of a fixed duration."""
    what = f"from {in_degrees(movement.start_deg)} to {in_degrees(movement.target_deg)} in {movement.duration:g} s"
    solution = solve(transcribe_movement(skeleton, movement), movement.costs, what)
    verification = verify(skeleton, movement, solution.motion)
    check(verification, movement)
    return Plan(
        reference=make_reference(skeleton.plant, solution.motion.states, solution.motion.inputs, movement.hold),
        solver=solution.solver,
        status=solution.status,
        iterations=solution.iterations,
        seconds=0.0,
        costs=solution.costs,
        verification=verification,
        t=solution.t,
        q=solution.q,
        v=solution.v,
        tau=solution.tau,
    )


def _recede(skeleton: Skeleton, movement: Movement, load_mass: float, horizon: float) -> Plan:
    """What the arm does under model predictive control, judged as a plan."""
    planner = RecedingHorizon(skeleton, movement, horizon)
    assert isinstance(movement.duration, float)
    loop = MakeMpcLoop(skeleton.arm, planner, load_mass)
    reference = loop.Run(movement.start, movement.duration + movement.hold)
    moving = slice(round(movement.duration / CONTROL_STEP) + 1)
    t, q, v, a, tau = (getattr(reference, name)[moving] for name in ("t", "q", "v", "a", "tau"))
    motion = Motion(
        PiecewisePolynomial.CubicHermite(t, np.hstack([q, v]).T, np.hstack([v, a]).T),
        PiecewisePolynomial.FirstOrderHold(t, tau.T),
    )
    verification = verify(skeleton, movement, motion)
    check(verification, movement)
    return Plan(
        reference=reference,
        solver=", ".join(sorted(planner.solvers)),
        status=f"{planner.solutions} solutions found",
        iterations=planner.iterations,
        seconds=0.0,
        costs=planner.costs(motion, t),
        verification=verification,
        t=t,
        q=q,
        v=v,
        tau=tau,
    )


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
