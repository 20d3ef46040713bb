"""Optimal references: what a movement is, what it costs, and the trajectory that costs least."""

from drakearm.planning.collocation import Plan, plan
from drakearm.planning.costs import Cost, HeldJoint, Posture, Torque, TorqueRate
from drakearm.planning.movement import Movement
from drakearm.planning.problem import Problem

__all__ = [
    "Cost",
    "HeldJoint",
    "Movement",
    "Plan",
    "Posture",
    "Problem",
    "Torque",
    "TorqueRate",
    "plan",
]
