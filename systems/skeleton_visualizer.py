"""SkeletonVisualizer: draws the bones of an arm in Meshcat, without a SceneGraph in the user's Diagram."""

import numpy as np
from pydrake.common.value import Value
from pydrake.geometry import Meshcat, MeshcatVisualizerParams
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import Context, LeafSystem

from drakearm.model import Arm
from drakearm.systems.muscle_drawing import upright
from drakearm.systems.muscle_visualizer import MuscleVisualizer
from drakearm.systems.skeleton_drawing import SkeletonDrawing, drawn_skeleton

_FORWARD, _UP = 0.35, 0.12  # of an oblique view, over the distance to the side
FIELD_OF_VIEW = 30.0  # degrees
STAGE = MeshcatVisualizerParams()  # of Drake's MeshcatVisualizer beside the muscles: draws as often as they are drawn
STAGE.publish_period = MuscleVisualizer.PUBLISH_PERIOD


class SkeletonVisualizer(LeafSystem):
    """Draws the shapes of an arm's skeleton in Meshcat, with its load.

    .. pydrake_system::

        name: SkeletonVisualizer
        input_ports:
        - body_poses
        output_ports: []

    ========== ==================== ==== ==================================================
    port       type                 unit meaning
    ========== ==================== ==== ==================================================
    body_poses list[RigidTransform] m    X_WB, MultibodyPlant's output of the same name
    ========== ==================== ==== ==================================================

    It draws every publish_period (s) and at forced publishes, and into Meshcat's recording, if one is being made.
    """

    def __init__(
        self,
        arm: Arm,
        plant: MultibodyPlant,
        meshcat: Meshcat,
        path: str = "/drake/skeleton",
        load_mass: float = 0.0,
        publish_period: float = MuscleVisualizer.PUBLISH_PERIOD,
    ):
        """plant: the finalized plant of the Diagram, which may hold other things too. load_mass: kg."""
        super().__init__()
        own, scene_graph = drawn_skeleton(arm, load_mass)
        self._drawing = SkeletonDrawing(meshcat, path, own, scene_graph)
        names = [own.get_body(BodyIndex(i)).name() for i in range(own.num_bodies())]
        self._bodies = [int(plant.GetBodyByName(name).index()) if plant.HasBodyNamed(name) else 0 for name in names]
        self._body_poses = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
        self.DeclarePeriodicPublishEvent(publish_period, 0.0, self._draw)
        self.DeclareForcedPublishEvent(self._draw)

    def _draw(self, context: Context) -> None:
        X_WB = self._body_poses.Eval(context)
        self._drawing.draw([X_WB[body] for body in self._bodies], context.get_time())


def joint_axis(arm: Arm, plant: MultibodyPlant, context: Context) -> np.ndarray:
    """The axis of the last joint in the world: seen from its tip, joint angles grow counterclockwise."""
    joint = plant.GetJointByName(arm.coordinates[-1])
    axis: np.ndarray = joint.frame_on_parent().CalcPoseInWorld(context).rotation().multiply(joint.revolute_axis())
    return axis


def oblique(arm: Arm, plant: MultibodyPlant, context: Context) -> np.ndarray:
    """The direction to the camera, of length 1, in the world: along the last joint's axis, a little forward and up."""
    across, up = joint_axis(arm, plant, context), upright(arm).rotation().inverse().multiply(np.array([0.0, 0.0, 1.0]))
    direction: np.ndarray = across + _FORWARD * np.cross(up, across) + _UP * up
    return direction / np.linalg.norm(direction)


def set_stage(meshcat: Meshcat, path: str, X_PW: RigidTransform) -> None:
    """Sets the pose on the page of what is below a path, hides grid and axes, and lights the scene."""
    meshcat.SetTransform(path, X_PW)
    for hidden in ("/Grid", "/Axes"):
        meshcat.SetProperty(hidden, "visible", False)
    meshcat.SetProperty("/Background/<object>", "top_color", [1.0, 1.0, 1.0])
    meshcat.SetProperty("/Background/<object>", "bottom_color", [0.90, 0.92, 0.95])
    meshcat.SetProperty("/Lights/AmbientLight/<object>", "intensity", 1.0)


def prepare_stage(meshcat: Meshcat, arm: Arm, plant: MultibodyPlant, path: str, X_PW: RigidTransform) -> None:
    """Sets the stage below a path, with the arm upright, and points the camera at the arm in its first posture.

    X_PW: the pose on the page of a world whose z axis points up.
    """
    X_PW = X_PW.multiply(upright(arm))
    set_stage(meshcat, path, X_PW)
    context = plant.CreateDefaultContext()
    frames = [plant.GetFrameByName(arm.tip_frame)]
    frames += [plant.GetBodyByName(body).body_frame() for muscle in arm.muscles for body, _ in muscle.points]
    points = np.array([frame.CalcPoseInWorld(context).translation() for frame in frames])
    low, high = points.min(axis=0), points.max(axis=0)
    center, reach = 0.5 * (low + high), float(np.linalg.norm(high - low))
    distance = 0.8 * reach / np.sin(np.radians(0.5 * FIELD_OF_VIEW))  # there is room to move
    camera = center + distance * oblique(arm, plant, context)
    meshcat.SetCamera(Meshcat.PerspectiveCamera(fov=FIELD_OF_VIEW))
    meshcat.SetCameraPose(X_PW.multiply(camera), X_PW.multiply(center))
