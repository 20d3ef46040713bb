"""Whether a plan holds between its knots too: its equations of motion and limits, on a dense grid of times."""

from dataclasses import dataclass

import numpy as np

from drakearm.errors import PlanningError
from drakearm.model.dynamics import forward_dynamics
from drakearm.model.motion import Motion
from drakearm.planning.movement import Movement
from drakearm.planning.skeleton import Skeleton
from drakearm.planning.transcription import angle_limits

GRID = 1e-3  # s
ANGLE_TOLERANCE = np.deg2rad(0.5)  # by which a spline may leave the limits that its knots keep


@dataclass(frozen=True)
class Verification:
    """What was found on a grid of GRID seconds. Margins are to the nearest limit, negative beyond it.

    The defects are how far a spline is from the equations of motion: q' from v, and v' from the skeleton's
    acceleration.
    """

    speed_defect: float  # rad/s
    acceleration_defect: float  # rad/s^2
    angle_margin: float  # rad
    speed_margin: float  # rad/s
    torque_margin: float  # Nm
    clearance: float | None  # m, None without an obstacle
    nearest_part: str | None  # of the arm to the obstacle
    nearest_time: float | None  # s


def verify(skeleton: Skeleton, movement: Movement, motion: Motion) -> Verification:
    """Looks at a motion from its start to its end."""
    start, end = motion.states.start_time(), motion.states.end_time()
    times = np.linspace(start, end, round((end - start) / GRID) + 1)
    q, v = np.split(motion.states.vector_values(times).T, 2, axis=1)
    q_rate, v_rate = np.split(motion.states.MakeDerivative().vector_values(times).T, 2, axis=1)
    tau = motion.inputs.vector_values(times).T
    a = np.array([forward_dynamics(*row, skeleton.dynamics) for row in zip(q, v, tau, strict=True)])
    lower, upper = angle_limits(skeleton, movement)
    clearance = nearest_part = nearest_time = None
    if skeleton.obstacle is not None:
        distances = np.array([skeleton.clearance(row)[0] for row in q])
        k, part = np.unravel_index(distances.argmin(), distances.shape)
        clearance, nearest_part = float(distances[k, part]), skeleton.parts[part]
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
    """Raises PlanningError where a plan that keeps its limits at the knots leaves them in between."""
    if found.angle_margin < -ANGLE_TOLERANCE:
        raise PlanningError(
            f"Between its knots the plan leaves the joint limits by {np.rad2deg(-found.angle_margin):.2g} deg: "
            f"expected at most {np.rad2deg(ANGLE_TOLERANCE):.2g}; more than {movement.knots} knots would help."
        )
    if found.clearance is not None and found.clearance < 0.5 * movement.clearance:
        raise PlanningError(
            f"Between its knots the plan has the {found.nearest_part} {100 * found.clearance:.2g} cm from the obstacle "
            f"at {found.nearest_time:.2f} s: expected at least {50 * movement.clearance:.2g} cm; more than "
            f"{movement.knots} knots would help."
        )
