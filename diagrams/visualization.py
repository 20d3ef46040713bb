"""How an arm is drawn live in Meshcat."""

from pydrake.geometry import Meshcat
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams.muscle_arm import MuscleArm
from drakearm.systems.muscle_visualizer import MuscleVisualizer
from drakearm.systems.skeleton_visualizer import SkeletonVisualizer, prepare_stage


def AddMuscleVisualizer(builder: DiagramBuilder, arm: MuscleArm, meshcat: Meshcat) -> None:
    """Draws an arm in Meshcat: bones, load and muscles, upright, lit, and with the camera in front of it.

    The Diagram needs no SceneGraph for it. Everything is below the path /drake.
    """
    skeleton = builder.AddNamedSystem(
        "skeleton_visualizer", SkeletonVisualizer(arm.arm, arm.plant, meshcat, load_mass=arm.load_mass)
    )
    builder.Connect(arm.plant.get_body_poses_output_port(), skeleton.GetInputPort("body_poses"))
    MuscleVisualizer.AddToBuilder(builder, arm.plant, arm.muscles, meshcat)
    prepare_stage(meshcat, arm.arm, arm.plant)
