"""How an arm is drawn live in Meshcat."""

from pydrake.geometry import Meshcat, MeshcatVisualizer, SceneGraph
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams.muscle_arm import MuscleArm
from drakearm.systems.muscle_visualizer import MuscleVisualizer
from drakearm.systems.skeleton_visualizer import STAGE, SkeletonVisualizer, prepare_stage


def AddMuscleVisualizer(
    builder: DiagramBuilder, arm: MuscleArm, meshcat: Meshcat, scene_graph: SceneGraph | None = None
) -> None:
    """Draws an arm in Meshcat: bones, load and muscles, upright, lit, and with the camera in front of it.

    scene_graph: if the plant of the arm is registered with one, Drake's visualizer draws all that is in it, also
    obstacles. Without one, the bones are drawn nevertheless. Everything is below the path /drake.
    """
    if scene_graph is not None:
        MeshcatVisualizer.AddToBuilder(builder, scene_graph, meshcat, STAGE)
    else:
        skeleton = builder.AddNamedSystem(
            "skeleton_visualizer", SkeletonVisualizer(arm.arm, arm.plant, meshcat, load_mass=arm.load_mass)
        )
        builder.Connect(arm.plant.get_body_poses_output_port(), skeleton.GetInputPort("body_poses"))
    MuscleVisualizer.AddToBuilder(builder, arm.plant, arm.muscles, meshcat)
    prepare_stage(meshcat, arm.arm, arm.plant)
