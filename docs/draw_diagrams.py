"""Draws the Diagrams that drakearm builds as docs/<diagram>.svg; needs Graphviz (`dot`)."""

from pathlib import Path

import numpy as np
import pydot
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.trajectories import PiecewisePolynomial

from drakearm.diagrams import AddMuscleArm, MakeMpcLoop, MakePolicyLoop, MakeTrackingTask, TrackingTask
from drakearm.model import load_arm
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.systems import RewardWeights


def muscle_arm() -> Diagram:
    """The arm alone, with its excitation exported."""
    builder = DiagramBuilder()
    arm = AddMuscleArm(builder, load_arm("arm14"))
    builder.ExportInput(arm.muscles.GetInputPort("excitation"), "excitation")
    diagram = builder.Build()
    diagram.set_name("muscle_arm")
    return diagram


def main() -> None:
    rest = np.zeros((76, 2))
    reference = Reference(CONTROL_STEP * np.arange(76), rest, rest, rest, rest)
    task = TrackingTask(load_arm("arm14"), reference, RewardWeights((1.0, 1.0), (0.0, 0.0), (0.0, 0.0)))
    loop = MakePolicyLoop(task, lambda observation: np.zeros(14)).diagram
    disturbance = PiecewisePolynomial.ZeroOrderHold([0.0, 1.0], np.zeros((2, 2)))
    mpc = MakeMpcLoop(load_arm("arm14"), lambda time, arm_state, before: before, disturbance=disturbance).diagram
    for diagram in (muscle_arm(), MakeTrackingTask(task)[0], loop, mpc):
        text = diagram.GetGraphvizString(max_depth=1, options={"plant/split": "I/O"})
        (graph,) = pydot.graph_from_dot_data(text)
        graph.write_svg(str(Path(__file__).parent / f"{diagram.get_name()}.svg"))


if __name__ == "__main__":
    main()
