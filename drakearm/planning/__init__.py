"""Planning with optimal control: what a movement is, what it costs, and the trajectory that costs least."""

from drakearm.planning.costs import (
    Cost,
    CostPiece,
    Duration,
    HeldJoint,
    Posture,
    SwitchedTarget,
    Torque,
    TorqueRate,
)
from drakearm.planning.feasibility import Feasibility, muscle_feasibility
from drakearm.planning.hand_costs import HandPosition, ObstacleDistance
from drakearm.planning.library import Library, plan_library
from drakearm.planning.movement import Movement
from drakearm.planning.movement_source import Mixture, MovementSource, Reaches
from drakearm.planning.planner import plan
from drakearm.planning.planning_model import PlanningModel
from drakearm.planning.problem import Problem
from drakearm.planning.reach import ReachPlanner, posture_at, reach
from drakearm.planning.receding_horizon import RecedingHorizon
from drakearm.planning.result import Plan
from drakearm.planning.verification import Verification

__all__ = [
    "Cost",
    "CostPiece",
    "Duration",
    "Feasibility",
    "HandPosition",
    "HeldJoint",
    "Library",
    "Mixture",
    "Movement",
    "MovementSource",
    "ObstacleDistance",
    "Plan",
    "PlanningModel",
    "Posture",
    "Problem",
    "ReachPlanner",
    "Reaches",
    "RecedingHorizon",
    "SwitchedTarget",
    "Torque",
    "TorqueRate",
    "Verification",
    "muscle_feasibility",
    "plan",
    "plan_library",
    "posture_at",
    "reach",
]
