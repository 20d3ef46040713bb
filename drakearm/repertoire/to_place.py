"""Reaches to a place of the hand: how they are planned, when they succeed, and how they are described."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drakearm.model.obstacle import Obstacle
from drakearm.planning import Movement, reach

START_DEG = (-20.0, 80.0)  # where the shipped reaches start
NEAR = 0.01  # m from the place, where a movement of the hand succeeds
_KNOTS = 31  # of a plan around an obstacle


def reach_past(
    obstacle: Obstacle | None, start_deg: Sequence[float], q: np.ndarray, seconds: float, hold: float
) -> Movement:
    """The movement to the angles q (n_q,), rad, in a time (s), with a rest of hold (s), around an obstacle if any."""
    movement = reach(start_deg, np.rad2deg(q), seconds, hold)
    return movement if obstacle is None else replace(movement, knots=_KNOTS)


def described(place: tuple[float, float], seconds: float, load_mass: float) -> str:
    """In words: a reach to x and y (m) in a time (s) with a load (kg)."""
    load = f" with {load_mass:g} kg" if load_mass else ""
    return f"to x = {place[0]:g} m, y = {place[1]:g} m in {seconds:g} s{load}"
