"""What planning knows of an arm: its plant, the equations compiled from it, and what an obstacle meets."""

from functools import cached_property

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.diagrams import MakeTorqueArm
from drakearm.errors import PlanningError
from drakearm.model import Arm
from drakearm.model.dynamics_table import read_dynamics
from drakearm.model.obstacle import Obstacle
from drakearm.model.points import PointTable, read_points
from drakearm.planning.clearance import clearances
from drakearm.planning.torques import gravity_torque
from drakearm.systems import CompiledSkeleton


class Skeleton:
    """An arm's skeleton with a load in its hand, and maybe an obstacle in its way.

    The plant is the judge; the compiled equations that are derived from it give the same optimum, but carrying
    derivatives through the plant would take six times as long.
    """

    def __init__(self, arm: Arm, load_mass: float = 0.0, obstacle: Obstacle | None = None):
        """load_mass: kg. Raises PlanningError for an obstacle where the arm has no outline."""
        self.arm = arm
        self.obstacle = obstacle
        # The problem's bounds are the torque limit: motors that clamp too would hide what exceeds it.
        self.plant: MultibodyPlant = MakeTorqueArm(arm, load_mass)
        self.dynamics = read_dynamics(self.plant)
        self.system = CompiledSkeleton(self.dynamics)
        self.lower, self.upper = self.plant.GetPositionLowerLimits(), self.plant.GetPositionUpperLimits()
        if obstacle is not None and not arm.outline:
            raise PlanningError(
                f"The arm {arm.name} has no outline: expected capsules in its file that an obstacle can meet."
            )

    @property
    def coordinates(self) -> tuple[str, ...]:
        return self.arm.coordinates

    @cached_property
    def tip(self) -> PointTable:
        """The tip of the hand, as a table of one point."""
        return read_points(self.plant, [(self.arm.tip_frame, (0.0, 0.0, 0.0))])

    @cached_property
    def _outline(self) -> tuple[PointTable, np.ndarray]:
        """The ends of the outline's capsules, and their radii."""
        ends = [end for capsule in self.arm.outline for end in capsule.ends]
        return read_points(self.plant, ends), np.array([capsule.radius for capsule in self.arm.outline])

    @property
    def parts(self) -> tuple[str, ...]:
        """The parts (c,) of the arm that an obstacle can meet."""
        return tuple(capsule.name for capsule in self.arm.outline)

    def clearance(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far (m) the parts are from the obstacle at q (n_q,), negative inside: (c,) and derivatives (c, n_q)."""
        assert self.obstacle is not None
        points, radii = self._outline
        center, direction = np.array(self.obstacle.position), self.obstacle.direction
        return clearances(q, points, radii + self.obstacle.radius, center, direction)

    def gravity_torque(self, q: np.ndarray) -> np.ndarray:
        """The joint torques (n_q,), Nm, that hold the arm still at q (n_q,)."""
        return gravity_torque(self.plant, q)
