"""How an arm is drawn live in Meshcat."""

from pydrake.geometry import Meshcat, MeshcatVisualizer, SceneGraph
from pydrake.math import RigidTransform
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams.muscle_arm import MuscleArm
from drakearm.systems.muscle_visualizer import MuscleVisualizer
from drakearm.systems.skeleton_visualizer import STAGE, SkeletonVisualizer, prepare_stage


def AddMuscleVisualizer(
    builder: DiagramBuilder,
    arm: MuscleArm,
    meshcat: Meshcat,
    scene_graph: SceneGraph | None = None,
    X_PW: RigidTransform | None = None,
) -> None:
    """Draws an arm in Meshcat: bones, load and muscles, upright, lit, and with the camera in front of it.

    scene_graph: if the plant of the arm is registered with one, Drake's visualizer draws all that is in it, also
    obstacles. Without one, the bones are drawn nevertheless. Everything is below the path /drake or, if the arm has a
    name, /NAME. X_PW: the pose of the arm's world on the page, whose z axis points up. Several arms on one page need
    it, or they are drawn on top of each other. The camera points at the arm that is added last.
    """
    path, prefix = (f"/{arm.name}", f"{arm.name}_") if arm.name else ("/drake", "")
    if scene_graph is not None:
        MeshcatVisualizer.AddToBuilder(builder, scene_graph, meshcat, STAGE)
    else:
        skeleton = builder.AddNamedSystem(
            f"{prefix}skeleton_visualizer",
            SkeletonVisualizer(arm.arm, arm.plant, meshcat, f"{path}/skeleton", arm.load_mass),
        )
        builder.Connect(arm.plant.get_body_poses_output_port(), skeleton.GetInputPort("body_poses"))
    MuscleVisualizer.AddToBuilder(
        builder, arm.plant, arm.muscles, meshcat, f"{path}/muscles", f"{prefix}muscle_visualizer"
    )
    prepare_stage(meshcat, arm.arm, arm.plant, path, X_PW or RigidTransform())
