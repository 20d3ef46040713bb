"""Optimal control of an arm with motors: from a movement to a plan."""

import time
from dataclasses import replace

import numpy as np
import scipy
from pydrake.trajectories import PiecewisePolynomial

from drakearm.diagrams import MakeMpcLoop
from drakearm.errors import PlanningError
from drakearm.model import Arm
from drakearm.model.motion import Motion
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import CONTROL_STEP
from drakearm.muscle.compile_time import without_compilation
from drakearm.planning.collocation import solve
from drakearm.planning.movement import Movement, in_degrees
from drakearm.planning.planning_model import PlanningModel
from drakearm.planning.receding_horizon import RecedingHorizon
from drakearm.planning.request import check_request
from drakearm.planning.result import Plan, make_reference
from drakearm.planning.transcription import transcribe_movement
from drakearm.planning.verification import check, verify

_TOO_SHORT = 1e9  # cost of a duration for which there is no plan
_LONGEST_SEARCH = 4.0  # s of processor time, after which no further duration is tried


def plan(
    arm: Arm,
    movement: Movement,
    load_mass: float = 0.0,
    obstacle: Obstacle | None = None,
    horizon: float | None = None,
) -> Plan:
    """The movement of least cost within the limits of joints, speeds and torques, and clear of the obstacle.

    load_mass: kg, in the hand. The movement starts at rest in equilibrium: the torques hold the arm against gravity and
    the acceleration is zero. It also ends so, unless its end is free. Raises PlanningError, with one sentence, if the
    movement does not fit the arm or has no plan.

    horizon: s. With it the movement is planned as by Denizdurduran et al. 2022: again and again, this many seconds
    ahead, from the state that the arm has reached (see `RecedingHorizon`). The plan is then the movement that the
    simulated arm made, and its knots are the control steps.
    """
    with without_compilation() as elapsed:
        model = PlanningModel(arm, load_mass, obstacle)
        check_request(model, movement)
        if horizon is not None:
            found = _plan_receding(model, movement, load_mass, horizon)
        elif isinstance(movement.duration, tuple):
            found = _best_duration(model, movement)
        else:
            found = _plan(model, movement)
        problem = found.reference.problem()
        if problem:
            raise PlanningError(f"The solver's plan is no movement of an arm: {problem}.")
        return replace(found, seconds=elapsed())


def _plan(model: PlanningModel, movement: Movement) -> Plan:
    """The movement of least cost with a fixed duration."""
    what = f"from {in_degrees(movement.start_deg)} to {in_degrees(movement.target_deg)} in {movement.duration:g} s"
    solution = solve(transcribe_movement(model, movement), movement.costs, what)
    verification = verify(model, movement, solution.motion)
    check(verification, movement)
    return Plan(
        reference=make_reference(model.plant, solution.motion, movement.hold),
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


def _plan_receding(model: PlanningModel, movement: Movement, load_mass: float, horizon: float) -> Plan:
    """The movement of the arm under model predictive control, in the form of a plan."""
    planner = RecedingHorizon(model, movement, horizon)
    assert isinstance(movement.duration, float)
    loop = MakeMpcLoop(model.arm, planner, load_mass)
    reference = loop.Run(movement.start, movement.duration + movement.hold)
    moving = slice(round(movement.duration / CONTROL_STEP) + 1)
    t, q, v, a, tau = (getattr(reference, name)[moving] for name in ("t", "q", "v", "a", "tau"))
    motion = Motion(
        PiecewisePolynomial.CubicHermite(t, np.hstack([q, v]).T, np.hstack([v, a]).T),
        PiecewisePolynomial.FirstOrderHold(t, tau.T),
    )
    verification = verify(model, movement, motion)
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


def _best_duration(model: PlanningModel, movement: Movement) -> Plan:
    """The plan of least cost among all durations, in whole control steps.

    With a fixed duration most costs are quadratic, so a plan is found quickly. A search over the duration takes less
    time than one problem in which the duration is a variable, because there all costs are nonlinear.
    """
    assert isinstance(movement.duration, tuple)
    shortest, longest = movement.duration
    plans: dict[int, Plan | PlanningError] = {}
    end = np.inf

    def cost(duration: float) -> float:
        """Of the best plan. Without one, a shorter duration costs more, so that the search turns to longer ones."""
        steps = round(duration / CONTROL_STEP)
        if steps not in plans:
            if time.thread_time() > end:
                return _TOO_SHORT
            try:
                plans[steps] = _plan(model, replace(movement, duration=round(steps * CONTROL_STEP, 6)))
            except PlanningError as error:
                plans[steps] = error
        found = plans[steps]
        return _TOO_SHORT * (2.0 - duration / longest) if isinstance(found, PlanningError) else _total(found)

    cost(longest)
    end = time.thread_time() + _LONGEST_SEARCH  # what is compiled during the first plan does not count
    cost(shortest)
    options = {"xatol": 0.5 * CONTROL_STEP}
    scipy.optimize.minimize_scalar(cost, bounds=(shortest, longest), method="bounded", options=options)
    succeeded = [found for found in plans.values() if isinstance(found, Plan)]
    if not succeeded:
        failed = plans[max(plans)]
        assert isinstance(failed, PlanningError)
        raise failed
    return min(succeeded, key=_total)


def _total(found: Plan) -> float:
    return sum(found.costs.values())
