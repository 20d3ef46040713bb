"""Pictures for files and tables for the terminal: of an arm, of plans and of movements."""

from drakearm.figures.arm_picture import draw_arm, write_arm_picture
from drakearm.figures.arm_table import muscle_table
from drakearm.figures.labelled_lines import draw_labelled_lines
from drakearm.figures.movement_picture import Movement, draw_movement, write_movement_picture
from drakearm.figures.perturbed_table import perturbed_table
from drakearm.figures.plan_picture import draw_plan, write_plan_picture
from drakearm.figures.plan_table import plan_facts, plans_table
from drakearm.figures.policy_table import evaluations_table, metrics_table
from drakearm.figures.side_view import SideView

__all__ = [
    "Movement",
    "SideView",
    "draw_arm",
    "draw_labelled_lines",
    "draw_movement",
    "draw_plan",
    "evaluations_table",
    "metrics_table",
    "muscle_table",
    "perturbed_table",
    "plan_facts",
    "plans_table",
    "write_arm_picture",
    "write_movement_picture",
    "write_plan_picture",
]
