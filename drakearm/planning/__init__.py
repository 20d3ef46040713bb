"""Optimal references: what a movement is, what it costs, and the trajectory that costs least."""

from drakearm.planning.cost import Cost, CostPiece
from drakearm.planning.costs import Duration, HeldJoint, Posture, SwitchedTarget, Torque, TorqueRate
from drakearm.planning.hand_costs import HandPosition, ObstacleDistance
from drakearm.planning.movement import Movement
from drakearm.planning.planner import plan
from drakearm.planning.problem import Problem
from drakearm.planning.receding_horizon import RecedingHorizon
from drakearm.planning.result import Plan
from drakearm.planning.skeleton import Skeleton

__all__ = [
    "Cost",
    "CostPiece",
    "Duration",
    "HandPosition",
    "HeldJoint",
    "Movement",
    "ObstacleDistance",
    "Plan",
    "Posture",
    "Problem",
    "RecedingHorizon",
    "Skeleton",
    "SwitchedTarget",
    "Torque",
    "TorqueRate",
    "plan",
]
