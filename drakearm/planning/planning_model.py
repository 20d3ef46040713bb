"""What planning knows about an arm: its plant, the equations compiled from it, its limits, and an obstacle."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.errors import PlanningError
from drakearm.model import Arm, MakeTorqueArm
from drakearm.model.clearance import Clearance
from drakearm.model.dynamics_table import read_dynamics
from drakearm.model.obstacle import Obstacle
from drakearm.model.points import PointTable, read_points
from drakearm.model.skeleton import gravity_torque
from drakearm.systems.compiled_skeleton import CompiledSkeleton_

ROUNDING = 1e-9  # rad, by which an angle may exceed its limit, so that a posture at a limit is allowed


class PlanningModel:
    """An arm with a load in its hand, driven by torques at the joints, and perhaps an obstacle in its way.

    Plans are solved on the equations that are compiled from the plant. Their optimum is that of the plant, and without
    them automatic differentiation of the plant would take six times as long.
    """

    def __init__(self, arm: Arm, load_mass: float = 0.0, obstacle: Obstacle | None = None):
        """load_mass: kg. Raises PlanningError for an obstacle if the arm has no outline."""
        self.arm = arm
        self.obstacle = obstacle
        # The plant's motors do not clamp. The problem's bounds limit the torques, and a clamp would hide a violation.
        self.plant: MultibodyPlant = MakeTorqueArm(arm, load_mass)
        self.dynamics = read_dynamics(self.plant)
        self.system = CompiledSkeleton_[float](self.dynamics)
        self.lower, self.upper = self.plant.GetPositionLowerLimits(), self.plant.GetPositionUpperLimits()
        if obstacle is not None and not arm.outline:
            raise PlanningError(
                f"The arm {arm.name} has no outline: expected capsules in its file, to keep clear of the obstacle."
            )

    @property
    def coordinates(self) -> tuple[str, ...]:
        return self.arm.coordinates

    def angle_limits(self, own_deg: Sequence[tuple[float, float]] | None) -> tuple[np.ndarray, np.ndarray]:
        """The lowest and highest joint angles, (n_q,) each, rad: joint limits, narrowed by a movement's own limits.

        own_deg: lowest and highest angle of each joint, degrees; None for the joint limits alone.
        """
        if own_deg is None:
            return self.lower, self.upper
        own = np.deg2rad(own_deg)
        return np.maximum(self.lower, own[:, 0]), np.minimum(self.upper, own[:, 1])

    def gravity_torque(self, q: np.ndarray) -> np.ndarray:
        """The joint torques (n_q,), Nm, that hold the arm still at q (n_q,), rad."""
        return gravity_torque(self.plant, q)

    @cached_property
    def tip(self) -> PointTable:
        """The tip of the hand, as a table of one point."""
        return read_points(self.plant, [(self.arm.tip_frame, (0.0, 0.0, 0.0))])

    @property
    def parts(self) -> tuple[str, ...]:
        """The names (c,) of the arm's parts that must stay clear of an obstacle: those of its outline."""
        return tuple(capsule.name for capsule in self.arm.outline)

    @cached_property
    def clearance(self) -> Clearance:
        """The distances of the parts from the obstacle, as a function of q."""
        assert self.obstacle is not None
        return Clearance(self.plant, self.arm, self.obstacle)
