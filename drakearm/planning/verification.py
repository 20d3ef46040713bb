"""Whether a plan also holds between its knots: its equations of motion and its limits, on a dense grid of times."""

from dataclasses import dataclass

import numpy as np

from drakearm.errors import PlanningError
from drakearm.model.dynamics import forward_dynamics
from drakearm.model.motion import Motion
from drakearm.planning.movement import Movement
from drakearm.planning.planning_model import PlanningModel

GRID = 1e-3  # s, between two times of the grid
ANGLE_TOLERANCE = np.deg2rad(0.5)  # by which a spline may exceed the limits between two knots


@dataclass(frozen=True)
class Verification:
    """What the grid of times shows. A margin is the smallest distance to a limit, negative where it is exceeded.

    A defect is the largest error of the splines in the equations of motion: q' minus v for the speed, and v' minus the
    acceleration that the torques give.
    """

    speed_defect: float  # rad/s
    acceleration_defect: float  # rad/s^2
    angle_margin: float  # rad
    speed_margin: float  # rad/s
    torque_margin: float  # Nm
    clearance: float | None  # m, None without an obstacle
    nearest_part: str | None  # of the arm to the obstacle
    nearest_time: float | None  # s


def verify(model: PlanningModel, movement: Movement, motion: Motion) -> Verification:
    """Evaluates a motion from its start to its end."""
    start, end = motion.states.start_time(), motion.states.end_time()
    times = np.linspace(start, end, round((end - start) / GRID) + 1)
    q, v = np.split(motion.states.vector_values(times).T, 2, axis=1)
    q_rate, v_rate = np.split(motion.states.MakeDerivative().vector_values(times).T, 2, axis=1)
    tau = motion.inputs.vector_values(times).T
    a = np.array([forward_dynamics(*row, model.dynamics) for row in zip(q, v, tau, strict=True)])
    lower, upper = model.angle_limits(movement.angle_limit_deg)
    clearance = nearest_part = nearest_time = None
    if model.obstacle is not None:
        distances = np.array([model.clearance(row)[0] for row in q])
        k, part = np.unravel_index(distances.argmin(), distances.shape)
        clearance, nearest_part = float(distances[k, part]), model.parts[part]
        nearest_time = float(times[k])
    return Verification(
        speed_defect=float(np.abs(q_rate - v).max()),
        acceleration_defect=float(np.abs(v_rate - a).max()),
        angle_margin=float(np.minimum(q - lower, upper - q).min()),
        speed_margin=float((np.array(movement.speed_limit) - np.abs(v)).min()),
        torque_margin=float((np.array(movement.torque_limit) - np.abs(tau)).min()),
        clearance=clearance,
        nearest_part=nearest_part,
        nearest_time=nearest_time,
    )


def check(found: Verification, movement: Movement) -> None:
    """Raises PlanningError if a plan exceeds the joint limits or comes too near to the obstacle between its knots."""
    if found.angle_margin < -ANGLE_TOLERANCE:
        raise PlanningError(
            f"Between its knots the plan exceeds the joint limits by {np.rad2deg(-found.angle_margin):.2g} deg: "
            f"expected at most {np.rad2deg(ANGLE_TOLERANCE):.2g}; use more than {movement.knots} knots."
        )
    if found.clearance is not None and found.clearance < 0.5 * movement.clearance:
        raise PlanningError(
            f"Between its knots the plan has the {found.nearest_part} {100 * found.clearance:.2g} cm from the obstacle "
            f"at {found.nearest_time:.2f} s: expected at least {50 * movement.clearance:.2g} cm; use more than "
            f"{movement.knots} knots."
        )
