"""What is reported about a plan: what was asked for, what was found, and whether the muscles can do it."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from drakearm.model import Arm
from drakearm.model.obstacle import Obstacle
from drakearm.planning.feasibility import Feasibility
from drakearm.planning.movement import Movement
from drakearm.planning.planning_model import PlanningModel
from drakearm.planning.result import Plan


@dataclass(frozen=True)
class PlanReport:
    """A movement with its name, its plan, and whether the muscles can do it."""

    name: str
    description: str
    arm: Arm
    movement: Movement
    load_mass: float  # kg, in the hand
    obstacle: Obstacle | None
    plan: Plan
    feasibility: Feasibility
    horizon: float | None = None  # s, if it was planned in a receding horizon

    @property
    def angle_limits(self) -> tuple[np.ndarray, np.ndarray]:
        """The lowest and highest joint angles (n_q,) that the movement may have, rad."""
        return PlanningModel(self.arm).angle_limits(self.movement.angle_limit_deg)

    @property
    def content(self) -> dict[str, Any]:
        """The content of plan.json, in SI units and radians; margins are negative beyond the limit."""
        plan, feasibility = self.plan, self.feasibility
        reserve = np.abs(feasibility.reserve).max(axis=0)
        return {
            "solver": plan.solver,
            "status": plan.status,
            "iterations": plan.iterations,
            "seconds": plan.seconds,
            "horizon": self.horizon,
            "duration": float(plan.t[-1]),
            "costs": plan.costs,
            "verification": asdict(plan.verification),
            "feasibility": {
                "feasible": feasibility.feasible,
                "verdict": feasibility.verdict,
                "largest_activation": float(feasibility.activation.max()),
                "largest_reserve": dict(zip(feasibility.coordinates, reserve.tolist(), strict=True)),
            },
        }
