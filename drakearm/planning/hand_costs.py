"""The costs of where the hand is: not quadratic, for they go through the skeleton's kinematics."""

from itertools import product

import numpy as np
from pydantic import ConfigDict, field_validator
from pydantic.dataclasses import dataclass
from pydrake.solvers import Binding
from scipy.optimize import minimize

from drakearm.errors import PlanningError
from drakearm.model.points import point_positions
from drakearm.planning.cost import CostPiece, NonNegative
from drakearm.planning.problem import Problem
from drakearm.planning.skeleton import Skeleton

_REACHED = 0.005  # m

_STRICT = ConfigDict(extra="forbid")


@dataclass(frozen=True, kw_only=True, config=_STRICT)
class HandPosition(CostPiece):
    """How far the tip of the hand is from a point, squared, along the way (integrated over time) and at the end."""

    type = "hand_position"
    position: tuple[float | None, float | None, float | None]  # in the world, m; null where any will do
    running: NonNegative = 0.0  # 1/(m^2 s)
    final: NonNegative = 0.0  # 1/m^2

    @field_validator("position")
    @classmethod
    def _says_something(cls, position: tuple) -> tuple:
        if not any(value is not None for value in position):
            raise ValueError("expected at least one coordinate")
        return position

    def add(self, problem: Problem) -> list[Binding]:
        self._check_reach(problem.skeleton)

        def cost(weight: float, knot: int) -> Binding:
            return problem.add_squares(lambda q: self._error(q, problem.skeleton), weight, problem.q(knot))

        costs = [cost(self.running * share, k) for k, share in enumerate(problem.shares) if self.running > 0.0]
        return [*costs, cost(self.final, len(problem.times) - 1)]

    def _error(self, q: np.ndarray, skeleton: Skeleton) -> tuple[np.ndarray, np.ndarray]:
        """How far the tip is from the point along each coordinate that matters, and the derivative by q."""
        position, jacobian = point_positions(q, skeleton.tip)
        along = [axis for axis, value in enumerate(self.position) if value is not None]
        return position[0, along] - np.array([self.position[axis] for axis in along]), jacobian[0, along]

    def _check_reach(self, skeleton: Skeleton) -> None:
        """Looks for joint angles within the limits that bring the tip there."""

        def squared(q: np.ndarray) -> tuple[float, np.ndarray]:
            error, jacobian = self._error(q, skeleton)
            return float(error @ error), 2.0 * error @ jacobian

        bounds = list(zip(np.maximum(skeleton.lower, -np.pi), np.minimum(skeleton.upper, np.pi), strict=True))
        starts = product(*[(0.75 * low + 0.25 * high, 0.25 * low + 0.75 * high) for low, high in bounds])
        nearest = min(minimize(squared, np.array(q), jac=True, bounds=bounds).fun for q in starts) ** 0.5
        if nearest > _REACHED:
            raise PlanningError(
                f"The hand position {list(self.position)} m is out of reach: within its joint limits the hand gets no "
                f"nearer than {nearest:.3g} m."
            )


@dataclass(frozen=True, kw_only=True, config=_STRICT)
class ObstacleDistance(CostPiece):
    """How far the tip of the hand is from the obstacle's axis, squared, integrated over time.

    Denizdurduran et al. 2022, eq. 8, adds this to the cost with a weight of 10: the hand then passes the obstacle
    closely. What keeps it away is the inequality on the clearance, which every movement with an obstacle has.
    """

    type = "obstacle_distance"
    weight: NonNegative  # 1/(m^2 s)

    def add(self, problem: Problem) -> list[Binding]:
        obstacle = problem.skeleton.obstacle
        if obstacle is None:
            raise PlanningError("A cost is of the distance to the obstacle: expected a scenario with an obstacle.")
        center, direction = np.array(obstacle.position), obstacle.direction

        across = np.eye(3) - np.outer(direction, direction)

        def away(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            position, jacobian = point_positions(q, problem.skeleton.tip)
            return across @ (position[0] - center), across @ jacobian[0]

        return [problem.add_squares(away, self.weight * share, problem.q(k)) for k, share in enumerate(problem.shares)]
