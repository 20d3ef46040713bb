"""Builds a Diagram with the muscle arm, holds its excitations constant, and plots joint angles and tendon forces.

Usage: python examples/compose_arm.py [compose_arm.png]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, LogVectorOutput

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.figures import draw_labelled_lines
from drakearm.model import load_arm


def main(picture: str = "compose_arm.png") -> None:
    arm = load_arm("arm14")
    excitation = np.full(len(arm.muscles), 0.02)
    excitation[arm.muscle_names.index("BRA")] = 0.15  # bends the elbow

    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm)
    source = builder.AddSystem(ConstantVectorSource(excitation))
    builder.Connect(source.get_output_port(), muscle_arm.muscles.GetInputPort("excitation"))
    state = LogVectorOutput(muscle_arm.plant.get_state_output_port(), builder, 0.01)
    force = LogVectorOutput(muscle_arm.muscles.GetOutputPort("tendon_force"), builder, 0.01)
    diagram = builder.Build()

    simulator = MakeSimulator(diagram)
    context = simulator.get_mutable_context()
    muscle_arm.SetState(context, q=np.deg2rad([0.0, 10.0]))
    simulator.AdvanceTo(1.0)

    figure, (angles, forces) = plt.subplots(2, 1, sharex=True, layout="constrained", figsize=(8, 7))
    log = state.FindLog(context)
    draw_labelled_lines(angles, log.sample_times(), np.rad2deg(log.data()[:2].T), arm.coordinates)
    angles.set(ylabel="joint angle (°)")
    log = force.FindLog(context)
    draw_labelled_lines(forces, log.sample_times(), log.data().T, arm.muscle_names)
    forces.set(xlabel="time (s)", ylabel="tendon force (N)")
    figure.savefig(picture)
    print(f"final angles {np.rad2deg(state.FindLog(context).data()[:2, -1]).round(1)} deg, plotted in {picture}")


if __name__ == "__main__":
    main(*sys.argv[1:])
