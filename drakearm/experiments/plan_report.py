"""What is told about a plan: the plan itself, and whether the muscles can do it."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from drakearm.experiments.scenario import Scenario
from drakearm.model import Arm
from drakearm.planning import Plan, PlanningModel
from drakearm.planning.feasibility import Feasibility


@dataclass(frozen=True)
class PlanReport:
    """A scenario's plan and what the muscles make of it."""

    scenario: Scenario
    arm: Arm
    plan: Plan
    feasibility: Feasibility

    @property
    def angle_limits(self) -> tuple[np.ndarray, np.ndarray]:
        """The lowest and highest joint angles (n_q,) that the movement may have, rad."""
        return PlanningModel(self.arm).angle_limits(self.scenario.movement.angle_limit_deg)

    @property
    def content(self) -> dict[str, Any]:
        """What plan.json holds. SI and radians; margins are negative beyond the limit."""
        plan, feasibility = self.plan, self.feasibility
        reserve = np.abs(feasibility.reserve).max(axis=0)
        return {
            "solver": plan.solver,
            "status": plan.status,
            "iterations": plan.iterations,
            "seconds": plan.seconds,
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
