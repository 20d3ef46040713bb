"""Draws the Diagrams that drakearm builds as docs/<diagram>.svg: `python docs/draw_diagrams.py`. It needs Graphviz."""

import argparse
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.trajectories import PiecewisePolynomial

from drakearm.diagrams import AddMuscleArm, MakeMpcLoop, MakePolicyLoop, MakeTrackingTask
from drakearm.model import load_arm
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.task import RewardWeights, TrackingTask


def muscle_arm() -> Diagram:
    """The arm alone, with its excitation exported."""
    builder = DiagramBuilder()
    arm = AddMuscleArm(builder, load_arm("arm14"))
    builder.ExportInput(arm.muscles.GetInputPort("excitation"), "excitation")
    diagram = builder.Build()
    diagram.set_name("muscle_arm")
    return diagram


def build_diagrams() -> list[Diagram]:
    """The Diagrams that are drawn; each is named as its file."""
    rest = np.zeros((76, 2))
    reference = Reference(CONTROL_STEP * np.arange(76), rest, rest, rest, rest)
    task = TrackingTask(load_arm("arm14"), reference, RewardWeights((1.0, 1.0), (0.0, 0.0), (0.0, 0.0)))
    loop = MakePolicyLoop(task, lambda observation: np.zeros(14)).diagram
    disturbance = PiecewisePolynomial.ZeroOrderHold([0.0, 1.0], np.zeros((2, 2)))
    mpc = MakeMpcLoop(load_arm("arm14"), lambda time, arm_state, before: before, disturbance=disturbance).diagram
    return [muscle_arm(), MakeTrackingTask(task)[0], loop, mpc]


def describe(diagram: Diagram) -> str:
    """The Diagram in Graphviz's language, with the inputs and the outputs of its plant as two boxes."""
    return diagram.GetGraphvizString(max_depth=1, options={"plant/split": "I/O"})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent, help="another folder than docs")
    folder = parser.parse_args().out
    if shutil.which("dot") is None:
        sys.exit("Graphviz is not installed: its program `dot` draws the Diagrams.")
    for diagram in build_diagrams():
        file = folder / f"{diagram.get_name()}.svg"
        subprocess.run(["dot", "-Tsvg", "-o", str(file)], input=describe(diagram), text=True, check=True)
        print(f"wrote {file}")


if __name__ == "__main__":
    main()
