"""Checks of a movement before it is planned: whether it fits the arm, and whether the arm can rest at its ends."""

import numpy as np

from drakearm.errors import PlanningError
from drakearm.planning.movement import Movement
from drakearm.planning.planning_model import ROUNDING, PlanningModel


def check_request(model: PlanningModel, movement: Movement) -> None:
    """Raises PlanningError, with one sentence, if the movement does not fit the arm or cannot start or end at rest."""
    _check_lengths(model, movement)
    _check_posture(model, movement, "start", movement.start)
    if movement.end == "rest":
        _check_posture(model, movement, "target", movement.target)


def _check_lengths(model: PlanningModel, movement: Movement) -> None:
    for name in ("start_deg", "target_deg", "speed_limit", "torque_limit", "angle_limit_deg"):
        values = getattr(movement, name)
        if values is not None and len(values) != len(model.coordinates):
            raise PlanningError(
                f"The movement's {name} has {len(values)} values: expected "
                f"{len(model.coordinates)}, for {', '.join(model.coordinates)}."
            )


def _check_posture(model: PlanningModel, movement: Movement, name: str, q: np.ndarray) -> None:
    """The arm must be able to rest there: within its joint limits, against gravity, clear of the obstacle."""
    lower, upper = model.angle_limits(movement.angle_limit_deg)
    torque = model.gravity_torque(q)
    for i, joint in enumerate(model.coordinates):
        if not lower[i] - ROUNDING <= q[i] <= upper[i] + ROUNDING:
            low, high = np.rad2deg([lower[i], upper[i]])
            raise PlanningError(
                f"The {name} has the {joint} at {np.rad2deg(q[i]):.4g} deg: expected an angle "
                f"within its joint limits, {low:.4g} to {high:.4g} deg."
            )
        if abs(torque[i]) > movement.torque_limit[i]:
            raise PlanningError(
                f"To rest at the {name}, the {joint} needs {abs(torque[i]):.3g} Nm against gravity: "
                f"expected at most the torque limit of the {joint}, "
                f"{movement.torque_limit[i]:.3g} Nm."
            )
    if model.obstacle is not None:
        clearance, _ = model.clearance(q)
        part = int(np.argmin(clearance))
        if clearance[part] < movement.clearance:
            where = "inside the obstacle" if clearance[part] < 0.0 else "too near to the obstacle"
            raise PlanningError(
                f"The {name} has the {model.parts[part]} {where}, at a distance of {100 * clearance[part]:.2g} cm: "
                f"expected at least {100 * movement.clearance:.2g} cm."
            )
