"""Reaches: plans from any state of an arm, at rest or moving, to a posture or to a position of the hand."""

import math
from collections.abc import Sequence

import numpy as np
import scipy
from pydrake.trajectories import PiecewisePolynomial

from drakearm.errors import PlanningError
from drakearm.model.arm import Arm
from drakearm.model.motion import Motion
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.model.skeleton import movement_torques
from drakearm.planning.collocation import solve
from drakearm.planning.costs import CostPiece, Posture, TorqueRate
from drakearm.planning.movement import Movement
from drakearm.planning.planning_model import PlanningModel
from drakearm.planning.result import make_reference
from drakearm.planning.transcription import transcribe

COSTS: tuple[CostPiece, ...] = (TorqueRate(weight=0.1), Posture(running=0.1))  # as in the shipped reaches
SPEED_LIMIT = 15.0  # rad/s, of each joint
TORQUE_LIMIT = 60.0  # Nm, of each joint
_EXACT = 1e-3  # m, by which the hand may miss a position
_KNOTS = 21
_STARTS = 5  # postures per joint from which a posture for the hand is searched


def reach(start_deg: Sequence[float], target_deg: Sequence[float], duration: float, hold: float = 0.2) -> Movement:
    """The movement from rest to rest with drakearm's usual limits and costs. duration, hold: s."""
    return Movement(
        start_deg=tuple(start_deg),
        target_deg=tuple(target_deg),
        duration=_whole(duration),
        hold=_whole(hold),
        speed_limit=(SPEED_LIMIT,) * len(start_deg),
        torque_limit=(TORQUE_LIMIT,) * len(start_deg),
        costs=list(COSTS),
    )


def posture_at(model: PlanningModel, x: float, y: float, near: np.ndarray) -> np.ndarray:
    """The joint angles (n_q,), rad, that bring the tip of the hand to x and y, m, in the world: the nearest ones.

    near: (n_q,), rad. Raises PlanningError if the hand cannot reach the position.
    """
    plant, tip = model.plant, model.plant.GetFrameByName(model.arm.tip_frame)
    context = plant.CreateDefaultContext()

    def miss(q: np.ndarray) -> np.ndarray:
        plant.SetPositions(context, q)
        return tip.CalcPoseInWorld(context).translation()[:2] - (x, y)

    lower, upper = np.maximum(model.lower, -math.pi), np.minimum(model.upper, math.pi)
    axes = [np.linspace(low, high, _STARTS + 2)[1:-1] for low, high in zip(lower, upper, strict=True)]
    starts = [near.clip(lower + 1e-6, upper - 1e-6), *np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, len(near))]
    found = [scipy.optimize.least_squares(miss, start, bounds=(lower, upper), xtol=1e-10) for start in starts[:1]]
    if np.linalg.norm(found[0].fun) > _EXACT:
        found += [scipy.optimize.least_squares(miss, start, bounds=(lower, upper), xtol=1e-10) for start in starts[1:]]
    exact = [each for each in found if np.linalg.norm(each.fun) <= _EXACT]
    if not exact:
        best = min(np.linalg.norm(each.fun) for each in found)
        raise PlanningError(
            f"The hand cannot reach x = {x:g} m, y = {y:g} m: it stays {100 * best:.1f} cm away. Expected a position "
            "within the ranges of the joints."
        )
    return min((each.x for each in exact), key=lambda q: float(np.abs(q - near).sum()))


class ReachPlanner:
    """Plans reaches of one arm: from any state, also a moving one, to rest at a target."""

    def __init__(self, arm: Arm, load_mass: float = 0.0, obstacle: Obstacle | None = None, hold: float = 0.2):
        """load_mass: kg. hold: s of rest at the end of a reference, which stays there afterwards."""
        self.model = PlanningModel(arm, load_mass, obstacle)
        self._hold = hold

    def rest(self, q: np.ndarray) -> Reference:
        """The reference that stays at joint angles q (n_q,), rad."""
        zero = np.zeros((2, len(q)))
        tau = np.tile(self.model.gravity_torque(q), (2, 1))
        return Reference(CONTROL_STEP * np.arange(2), np.tile(q, (2, 1)), zero, zero, tau)

    def __call__(
        self, q: np.ndarray, v: np.ndarray, target: np.ndarray, duration: float, a: np.ndarray | None = None
    ) -> Reference:
        """From angles q, speeds v and accelerations a, (n_q,) each, to rest at the target (n_q,), rad, in a time (s).

        a: rad/s^2, by default 0. Raises PlanningError if there is no such movement within the limits.
        """
        model, end = self.model, _whole(duration)
        a = np.zeros_like(q) if a is None else a
        lower, upper = model.lower, model.upper
        movement = reach(np.rad2deg(q.clip(lower, upper)), np.rad2deg(target), end, self._hold)
        times = np.linspace(0.0, end, _KNOTS)
        zero = np.zeros_like(q)
        guess = _smoothest((q, v, a), (target, zero, zero), times)
        states = PiecewisePolynomial.CubicHermite(times, np.hstack(guess[:2]).T, np.hstack(guess[1:]).T)
        torques = movement_torques(model.plant, *guess)
        motion = Motion(states, PiecewisePolynomial.FirstOrderHold(times, torques.T))
        start = np.concatenate([q, v]), torques[0]
        what = f"to the target in {end:g} s"
        found = solve(transcribe(model, movement, times, start, motion, arrives=True), movement.costs, what)
        return make_reference(model.plant, found.motion, movement.hold)


def _smoothest(
    start: tuple[np.ndarray, ...], end: tuple[np.ndarray, ...], times: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, v, a, each (N, n_q), of the polynomial of degree 5 between two states, at times (N,), s.

    start, end: q, v and a, (n_q,) each. It is the movement of least jerk (Flash and Hogan 1985).
    """
    powers = np.arange(6)

    def rows(t: float | np.ndarray) -> list[np.ndarray]:
        t = np.asarray(t, dtype=float)[..., None]
        first = powers * t ** np.maximum(powers - 1, 0)
        return [t**powers, first, powers * (powers - 1) * t ** np.maximum(powers - 2, 0)]

    matrix = np.stack([*rows(times[0]), *rows(times[-1])])
    coefficients = np.linalg.solve(matrix, np.stack([*start, *end]))
    q, v, a = (row @ coefficients for row in rows(times))
    return q, v, a


def _whole(seconds: float) -> float:
    """The nearest whole number of control steps, at least one, s."""
    return round(max(1, round(seconds / CONTROL_STEP)) * CONTROL_STEP, 6)
