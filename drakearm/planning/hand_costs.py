"""The costs of the hand's position: not quadratic, because it is a nonlinear function of the joint angles."""

from itertools import product

import numpy as np
import scipy
from pydantic import field_validator
from pydrake.solvers import Binding

from drakearm.errors import PlanningError
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Finite, NonNegative
from drakearm.model.points import point_positions
from drakearm.planning.costs import CostPiece
from drakearm.planning.planning_model import PlanningModel
from drakearm.planning.problem import Problem

_REACHED = 0.005  # m: a smaller distance from the position counts as reached


@checked_dataclass(kw_only=True)
class HandPosition(CostPiece):
    """Distance of the hand's tip from a point, squared, during the movement (integrated over time) and at its end."""

    type = "hand_position"
    position: tuple[Finite | None, Finite | None, Finite | None]  # world, m; null: does not matter
    running: NonNegative = 0.0  # 1/(m^2 s)
    final: NonNegative = 0.0  # 1/m^2

    @field_validator("position")
    @classmethod
    def _has_a_coordinate(cls, position: tuple) -> tuple:
        if not any(value is not None for value in position):
            raise ValueError("expected at least one coordinate that is not null")
        return position

    def add(self, problem: Problem) -> list[Binding]:
        self._check_reach(problem.model)

        def cost(weight: float, knot: int) -> Binding:
            return problem.add_squares(lambda q: self._error(q, problem.model), weight, problem.q(knot))

        costs = [cost(self.running * share, k) for k, share in enumerate(problem.shares) if self.running > 0.0]
        return [*costs, cost(self.final, len(problem.times) - 1)]

    def _error(self, q: np.ndarray, model: PlanningModel) -> tuple[np.ndarray, np.ndarray]:
        """The tip's position minus the point, in the coordinates that matter, and the derivative by q."""
        position, jacobian = point_positions(q, model.tip)
        along = [axis for axis, value in enumerate(self.position) if value is not None]
        return position[0, along] - np.array([self.position[axis] for axis in along]), jacobian[0, along]

    def _check_reach(self, model: PlanningModel) -> None:
        """Raises PlanningError if no joint angles within the joint limits bring the tip to the point."""

        def squared(q: np.ndarray) -> tuple[float, np.ndarray]:
            error, jacobian = self._error(q, model)
            return float(error @ error), 2.0 * error @ jacobian

        lower = np.where(np.isfinite(model.lower), model.lower, -np.pi)
        upper = np.where(np.isfinite(model.upper), model.upper, np.pi)
        bounds = list(zip(lower, np.maximum(lower, upper), strict=True))
        starts = product(*[(0.75 * low + 0.25 * high, 0.25 * low + 0.75 * high) for low, high in bounds])
        nearest = min(scipy.optimize.minimize(squared, np.array(q), jac=True, bounds=bounds).fun for q in starts) ** 0.5
        if nearest > _REACHED:
            raise PlanningError(
                f"The hand position {list(self.position)} m is out of reach: within the joint limits the hand comes no "
                f"nearer than {nearest:.3g} m."
            )


@checked_dataclass(kw_only=True)
class ObstacleDistance(CostPiece):
    """Distance of the hand's tip from the obstacle's axis, squared and integrated over time.

    Denizdurduran et al. 2022, eq. 8, adds this to the cost with a weight of 10, so that the hand passes close to the
    obstacle. The constraint on the clearance, which every movement with an obstacle has, keeps the hand away from it.
    """

    type = "obstacle_distance"
    weight: NonNegative  # 1/(m^2 s)

    def add(self, problem: Problem) -> list[Binding]:
        obstacle = problem.model.obstacle
        if obstacle is None:
            raise PlanningError("The cost obstacle_distance has no obstacle: expected a scenario with an obstacle.")
        center, direction = np.array(obstacle.position), obstacle.direction
        across = np.eye(3) - np.outer(direction, direction)

        def away(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            position, jacobian = point_positions(q, problem.model.tip)
            return across @ (position[0] - center), across @ jacobian[0]

        return [problem.add_squares(away, self.weight * share, problem.q(k)) for k, share in enumerate(problem.shares)]
