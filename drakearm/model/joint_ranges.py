"""Whether joint angles are in the ranges of the joints, as one sentence for people."""

import numpy as np

from drakearm.errors import StateError
from drakearm.model.arm import Arm
from drakearm.model.skeleton import skeleton_plant

EXCESS = 0.15  # rad, by which an angle may exceed its range: the stops of the joints are elastic


def range_problem(arm: Arm, q: np.ndarray) -> str | None:
    """Which joint is outside of its range by more than EXCESS: joint, found, expected. None if there is none.

    q: joint angles of one posture or of several ones, (n_q,) or (N, n_q), rad. Of all that are outside, the one that is
    furthest outside is named. Joints without a range may have any angle.
    """
    plant = skeleton_plant(arm)
    lower, upper = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
    postures = np.atleast_2d(q)
    excess = np.maximum(lower - postures, postures - upper)
    k, j = np.unravel_index(int(excess.argmax()), excess.shape)
    if excess[k, j] <= EXCESS:
        return None
    found, low, high = postures[k, j], lower[j], upper[j]
    return (
        f"the {arm.coordinates[j]} is at {found:.4g} rad ({np.rad2deg(found):.4g} deg), expected an angle in the range "
        f"of this joint, {low:.4g} to {high:.4g} rad ({np.rad2deg(low):.4g} to {np.rad2deg(high):.4g} deg)"
    )


def require_in_ranges(arm: Arm, q: np.ndarray) -> None:
    """Raises StateError, which names the joint, where `range_problem` finds one."""
    problem = range_problem(arm, q)
    if problem:
        raise StateError(f"The joint angles are impossible for {arm.name}: {problem}.")
