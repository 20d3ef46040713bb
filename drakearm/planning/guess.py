"""The initial guess of the optimization: the minimum-jerk movement, bent around an obstacle, and its torques."""

from collections.abc import Callable
from itertools import product

import numpy as np
from pydrake.trajectories import PiecewisePolynomial

from drakearm.errors import PlanningError
from drakearm.model.motion import Motion
from drakearm.model.skeleton import movement_torques
from drakearm.planning.movement import Movement, in_degrees
from drakearm.planning.planning_model import PlanningModel

_LONGEST_DETOUR = np.deg2rad(60.0)  # by which one joint angle may leave the straight way
_DETOURS = 625  # about how many are tried: 25 for each of two joints
_SAMPLES = 41  # along a detour


def straight_guess(model: PlanningModel, movement: Movement, times: np.ndarray) -> Motion:
    """The minimum-jerk movement, around the obstacle, at times (N,), s. Raises PlanningError if there is no way."""
    detour: np.ndarray | float = 0.0
    if model.obstacle is not None:
        found = smallest_detour(
            movement.start,
            movement.target,
            model.angle_limits(movement.angle_limit_deg),
            lambda q: bool(model.clearance(q)[0].min() >= movement.clearance),
        )
        if found is None:
            raise PlanningError(
                f"There is no way around the obstacle from {in_degrees(movement.start_deg)} to "
                f"{in_degrees(movement.target_deg)}: every detour within the joint limits meets it."
            )
        detour = found
    q, v, a = minimum_jerk(movement.start, movement.target, times, detour)
    states = PiecewisePolynomial.CubicHermite(times, np.hstack([q, v]).T, np.hstack([v, a]).T)
    torques = movement_torques(model.plant, q, v, a)
    return Motion(states, PiecewisePolynomial.FirstOrderHold(times, torques.T))


def minimum_jerk(
    start: np.ndarray, target: np.ndarray, times: np.ndarray, detour: np.ndarray | float = 0.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, v, a, each (N, n_q), of the smoothest movement from rest to rest, at times (N,), s.

    Flash and Hogan 1985, applied to each joint angle. detour: (n_q,) rad, added to the angles in the movement's middle,
    with a smooth bump around it.
    """
    duration = times[-1] - times[0]
    s = ((times - times[0]) / duration)[:, None]
    way = target - start
    q = start + way * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    v = way / duration * 30.0 * s**2 * (1.0 - s) ** 2
    a = way / duration**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)
    bump = 64.0 * detour
    q = q + bump * s**3 * (1.0 - s) ** 3
    v = v + bump / duration * 3.0 * s**2 * (1.0 - s) ** 2 * (1.0 - 2.0 * s)
    a = a + bump / duration**2 * 6.0 * s * (1.0 - s) * (1.0 - 5.0 * s * (1.0 - s))
    return q, v, a


def smallest_detour(
    start: np.ndarray,
    target: np.ndarray,
    limits: tuple[np.ndarray, np.ndarray],
    clear: Callable[[np.ndarray], bool],
) -> np.ndarray | None:
    """The smallest detour (n_q,), rad, on which the arm stays within joint limits and is clear; None if there is none.

    clear: whether the arm at q (n_q,) is clear of everything. The guess must not go through an obstacle: from there a
    solver may find a plan that is on one side of it at one knot and on the other side at the next.
    """
    times = np.linspace(0.0, 1.0, _SAMPLES)
    lower, upper = np.minimum(limits[0], np.minimum(start, target)), np.maximum(limits[1], np.maximum(start, target))
    count = 2 * int(_DETOURS ** (1.0 / len(start)) / 2.0) + 1
    one_joint = np.linspace(-_LONGEST_DETOUR, _LONGEST_DETOUR, count)
    detours = [np.array(detour) for detour in product(one_joint, repeat=len(start))]
    for detour in sorted(detours, key=lambda d: float(d @ d)):
        q, _, _ = minimum_jerk(start, target, times, detour)
        if np.all(q >= lower) and np.all(q <= upper) and all(clear(row) for row in q[1:-1]):
            return detour
    return None
