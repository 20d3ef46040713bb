"""The receding horizon: a movement is planned again and again, from the state that the arm has reached."""

import math

import numpy as np
from pydrake.trajectories import PiecewisePolynomial

from drakearm.errors import PlanningError
from drakearm.model.motion import Motion
from drakearm.planning.collocation import evaluate, guess_scale, solve
from drakearm.planning.costs import Posture, TorqueRate
from drakearm.planning.guess import straight_guess
from drakearm.planning.movement import Movement
from drakearm.planning.planning_model import PlanningModel
from drakearm.planning.transcription import transcribe, transcribe_movement
from drakearm.systems.collocation_mpc import REPLANNING_STEP

RECOVERY = 0.4  # s: a disturbed arm gets at least this much time to reach its target
LONGEST = 10.0  # s: each plan has a knot per replanning step of the horizon
STRAYED = (0.01, 0.2)  # rad and rad/s: an arm that is farther from its plan has been disturbed
HOLDING = (Posture(running=100.0, running_speed=1.0), TorqueRate(weight=0.1))  # the costs after the movement
_FEWEST = 6  # knots


class RecedingHorizon:
    """Plans a movement from any state at any time, over a horizon ahead: a planner for `CollocationMpc`.

    As in Denizdurduran et al. 2022, the knots are one replanning step apart, and only the first step of each plan is
    carried out. The previous plan is the initial guess of the next one, which starts with the torques that the previous
    plan has at that time.

    A movement that ends at rest gets its end as a constraint as soon as the horizon reaches it. From then on the
    horizon ends when the movement ends. If that time has passed, or if the arm has strayed from its plan, the horizon
    is at least RECOVERY. The movement's own costs count until its end, and after that the costs HOLDING. A movement
    with a free end follows its own costs indefinitely.
    """

    def __init__(self, model: PlanningModel, movement: Movement, horizon: float):
        """horizon: s, from RECOVERY to LONGEST. Raises PlanningError for another horizon and for a free duration."""
        if not RECOVERY <= horizon <= LONGEST:
            raise PlanningError(
                f"The horizon is {horizon:g} s: expected at least {RECOVERY:g} s and at most {LONGEST:g} s."
            )
        if isinstance(movement.duration, tuple):
            raise PlanningError("The movement's duration is free: expected a fixed one for a receding horizon.")
        self._model, self._movement, self._horizon = model, movement, horizon
        self._duration = movement.duration
        self._cost_scale = self._scale()
        self.solutions = 0
        self.iterations = 0
        self.solvers: set[str] = set()

    def __call__(self, time: float, arm_state: np.ndarray, before: Motion | None) -> Motion:
        """The motion from a state (2 n_q,) at a time (s). before: the previous plan, if there is one.

        Raises PlanningError if there is no plan.
        """
        model, movement = self._model, self._movement
        end = time + self._horizon
        arrives = movement.end == "rest" and end >= self._duration
        if arrives:
            end = self._arrival(time, arm_state, before)
            if before is not None and end - time < REPLANNING_STEP:
                return before  # less than a step of it is left
        knots = max(_FEWEST, math.ceil((end - time) / REPLANNING_STEP - 1e-6) + 1)
        times = np.linspace(time, end, knots)
        if before is None:
            torque = model.gravity_torque(arm_state[: len(movement.start)])
            guess = straight_guess(model, movement, np.linspace(time, max(end, self._duration), knots))
        else:
            torque = before.inputs.value(time).ravel()
            guess = _continued(before, times)
        problem = transcribe(model, movement, times, (arm_state, torque), guess, arrives=arrives)
        if movement.end == "rest" and time >= self._duration:
            solution = solve(problem, HOLDING, f"to hold the arm at {time:.2f} s", cost_scale=1.0)
        else:
            solution = solve(problem, movement.costs, f"at {time:.2f} s", self._cost_scale)
        self.solutions += 1
        self.iterations += solution.iterations
        self.solvers.add(solution.solver)
        return solution.motion

    def _arrival(self, time: float, arm_state: np.ndarray, before: Motion | None) -> float:
        """The time (s) of arrival. Keep the arrival time fixed: postponing it at every step would never arrive."""
        if before is None:
            return max(self._duration, time + RECOVERY)
        end = max(self._duration, before.states.end_time())
        off = np.abs(arm_state - before.states.value(min(time, before.states.end_time())).ravel())
        strayed = np.any(off > np.repeat(STRAYED, len(off) // 2))
        return max(end, time + RECOVERY) if strayed or time >= end else end

    def costs(self, motion: Motion, times: np.ndarray) -> dict[str, float]:
        """What each type of the movement's costs contributes to a motion, from its values at times (N,), s."""
        start = (motion.states.value(times[0]).ravel(), motion.inputs.value(times[0]).ravel())
        problem = transcribe(self._model, self._movement, times, start, motion, arrives=False)
        return evaluate(problem, self._movement.costs)

    def _scale(self) -> float:
        """The scale of the whole movement's costs: those of an arm that has arrived are too small to give a scale."""
        problem = transcribe_movement(self._model, self._movement)
        return guess_scale(problem, [binding for cost in self._movement.costs for binding in cost.add(problem)])


def _continued(before: Motion, times: np.ndarray) -> Motion:
    """A motion at other times (N,), s; after its end the arm rests at its last position."""
    within = np.minimum(times, before.states.end_time())
    states, inputs = before.states.vector_values(within), before.inputs.vector_values(within)
    states[states.shape[0] // 2 :, times > before.states.end_time() + 1e-9] = 0.0
    return Motion(PiecewisePolynomial.FirstOrderHold(times, states), PiecewisePolynomial.FirstOrderHold(times, inputs))
