"""What can be said about a movement before it is solved: whether it fits the arm and can start and end."""

import numpy as np

from drakearm.errors import PlanningError
from drakearm.planning.movement import Movement
from drakearm.planning.skeleton import Skeleton
from drakearm.planning.transcription import ROUNDING, angle_limits


def check_request(skeleton: Skeleton, movement: Movement) -> None:
    """Raises PlanningError, in one sentence, where the movement does not fit the arm or cannot start or end."""
    _check_lengths(skeleton, movement)
    _check_posture(skeleton, movement, "start", movement.start)
    if movement.end == "rest":
        _check_posture(skeleton, movement, "target", movement.target)


def _check_lengths(skeleton: Skeleton, movement: Movement) -> None:
    for name in ("start_deg", "target_deg", "speed_limit", "torque_limit", "angle_limit_deg"):
        values = getattr(movement, name)
        if values is not None and len(values) != len(skeleton.coordinates):
            raise PlanningError(
                f"The movement's {name} has {len(values)} values: expected "
                f"{len(skeleton.coordinates)}, for {', '.join(skeleton.coordinates)}."
            )


def _check_posture(skeleton: Skeleton, movement: Movement, name: str, q: np.ndarray) -> None:
    """The arm must be able to rest there: within joint limits, against gravity, clear of the obstacle."""
    lower, upper = angle_limits(skeleton, movement)
    torque = skeleton.gravity_torque(q)
    for i, joint in enumerate(skeleton.coordinates):
        if not lower[i] - ROUNDING <= q[i] <= upper[i] + ROUNDING:
            low, high = np.rad2deg([lower[i], upper[i]])
            raise PlanningError(
                f"The {name} has the {joint} at {np.rad2deg(q[i]):.4g} deg: expected an angle "
                f"within its joint limits, {low:.4g} to {high:.4g} deg."
            )
        if abs(torque[i]) > movement.torque_limit[i]:
            raise PlanningError(
                f"To rest at the {name}, gravity asks {abs(torque[i]):.3g} Nm of the {joint}: "
                f"expected at most the torque limit of the {joint}, "
                f"{movement.torque_limit[i]:.3g} Nm."
            )
    if skeleton.obstacle is not None:
        clearance, _ = skeleton.clearance(q)
        part = int(np.argmin(clearance))
        if clearance[part] < movement.clearance:
            where = "inside the obstacle" if clearance[part] < 0.0 else "too near to the obstacle"
            raise PlanningError(
                f"The {name} has the {skeleton.parts[part]} {where}, at a distance of {100 * clearance[part]:.2g} cm: "
                f"expected at least {100 * movement.clearance:.2g} cm."
            )
