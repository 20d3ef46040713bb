"""Drives the arm by hand: one slider per muscle sets its excitation, and the arm moves in the browser in real time.

`python examples/excitations_in_meshcat.py` prints the address of the page. A button there ends it.
"""

import argparse

import numpy as np
from pydrake.geometry import Meshcat, MeshcatParams
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams import AddMuscleArm, AddMuscleVisualizer, MakeSimulator
from drakearm.model import load_arm

START = np.deg2rad([0.0, 30.0])
FRAME = 0.03  # s, between two looks at the sliders


def main(seconds: float) -> np.ndarray:
    """Runs for at most some seconds of the arm's time. Returns the last joint angles, rad."""
    arm = load_arm()
    meshcat = Meshcat(MeshcatParams(host="localhost"))
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm)
    AddMuscleVisualizer(builder, muscle_arm, meshcat)
    builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
    diagram = builder.Build()
    simulator = MakeSimulator(diagram)
    context = simulator.get_mutable_context()
    muscle_arm.SetState(context, START)
    for name in arm.muscle_names:
        meshcat.AddSlider(name, 0.0, 1.0, 0.01, 0.05)
    meshcat.AddButton("end")
    simulator.set_target_realtime_rate(1.0)
    print(f"open {meshcat.web_url()} in a browser")
    while context.get_time() < seconds and meshcat.GetButtonClicks("end") == 0:
        excitation = np.array([meshcat.GetSliderValue(name) for name in arm.muscle_names])
        diagram.GetInputPort("excitation").FixValue(context, excitation)
        simulator.AdvanceTo(context.get_time() + FRAME)
    return muscle_arm.plant.GetPositions(muscle_arm.plant.GetMyContextFromRoot(context))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=3600.0, help="when it ends by itself")
    print(np.rad2deg(main(parser.parse_args().seconds)).round(1))
