"""The scene of a replay in its own Meshcat: the arm with its muscles, and the reference as a ghost."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Mesh, Meshcat, MeshcatParams, Rgba, SceneGraph, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex

from drakearm.model import Arm
from drakearm.model.obstacle import Obstacle, add_obstacle
from drakearm.model.recording import Recording
from drakearm.model.skeleton import add_skeleton, skeleton_plant
from drakearm.systems.muscle_drawing import MuscleDrawing, upright
from drakearm.systems.skeleton_drawing import SkeletonDrawing
from drakearm.systems.skeleton_visualizer import FIELD_OF_VIEW, joint_axis, oblique, set_stage
from drakearm.systems.smooth_mesh import tube

GHOST_COLOR = Rgba(0.0, 0.58, 0.55, 0.25)
PATH_COLOR = Rgba(0.95, 0.55, 0.05, 1.0)
TARGET_COLOR = Rgba(0.10, 0.65, 0.35, 0.55)
TARGET_RADIUS = 0.01  # m, times `drawing_scale`

_ROOT = "/drakearm"
_DOT_RADIUS = 0.006  # m, times `drawing_scale`
_PATH_RADIUS = 0.002  # m, times `drawing_scale`
_NARROW = 2.0  # degrees, a field of view that shows distances across the view without perspective
_MARGIN = 1.15  # the distance of the camera over the smallest one that shows the whole arm
_CLOSE = 0.12  # m, around the path of the hand, times `drawing_scale`
_SHORT = 0.3  # m, the length of a limb beside which the sizes above are too large


@dataclass(frozen=True)
class View:
    """How a camera looks at a ball that holds what is to be seen. In Meshcat's world, whose z axis points up."""

    center: list[float]  # m
    radius: float  # m
    direction: list[float]  # from the center to the camera, of length 1
    fov: float  # degrees


def drawing_scale(arm: Arm) -> float:
    """1, but less for a limb so small that it would vanish behind the path of its tip."""
    plant = skeleton_plant(arm)
    context = plant.CreateDefaultContext()
    frames = [plant.GetJointByName(name).frame_on_child() for name in arm.coordinates]
    frames.append(plant.GetFrameByName(arm.tip_frame))
    points = [frame.CalcPoseInWorld(context).translation() for frame in frames]
    return min(1.0, float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()) / _SHORT)


class ReplayScene:
    """An arm in its own Meshcat, which closes when the scene is deleted. `draw` shows the arm as in a recording."""

    def __init__(
        self, arm: Arm, load_mass: float = 0.0, obstacle: Obstacle | None = None, port: int | None = 0
    ) -> None:
        """load_mass: kg, in the hand. port: of the page on this computer: 0 for any, None for one from 7000."""
        self._arm, self._scale = arm, drawing_scale(arm)
        self._plant = MultibodyPlant(time_step=0.0)
        scene_graph = SceneGraph()
        self._plant.RegisterAsSourceForSceneGraph(scene_graph)
        add_skeleton(self._plant, arm, load_mass)
        if obstacle is not None:
            add_obstacle(self._plant, obstacle)
        self._plant.Finalize()
        self._context = self._plant.CreateDefaultContext()

        self.meshcat = Meshcat(MeshcatParams(host="localhost", port=port))
        set_stage(self.meshcat, _ROOT, upright(arm))
        self._skeleton = SkeletonDrawing(self.meshcat, f"{_ROOT}/arm", self._plant, scene_graph)
        self._ghost = SkeletonDrawing(self.meshcat, f"{_ROOT}/reference", self._plant, scene_graph, GHOST_COLOR)
        self._muscles = MuscleDrawing(self.meshcat, f"{_ROOT}/muscles", arm, self._plant)
        self._surroundings = _still_meshes(self._plant, scene_graph)
        tip = self._plant.GetFrameByName(arm.tip_frame)
        dot = f"{_ROOT}/arm/{tip.body().name()}/tip"  # which point of the hand has the path that is drawn
        self.meshcat.SetTransform(dot, tip.GetFixedPoseInBodyFrame())
        translucent = Rgba(PATH_COLOR.r(), PATH_COLOR.g(), PATH_COLOR.b(), 0.98)  # so that it is drawn after the hand
        self.meshcat.SetObject(dot, Sphere(_DOT_RADIUS * self._scale), translucent)
        self.meshcat.SetProperty(f"{dot}/<object>", "material.depthTest", False)  # visible also inside of the hand

    def draw(self, recording: Recording, i: int, time_in_recording: float | None = None) -> None:
        """Draws sample i. If Meshcat is recording, it stores this frame at time_in_recording (s)."""
        X_WB = self._body_poses(recording.q[i])
        self._skeleton.draw(X_WB, time_in_recording)
        self._muscles.draw(X_WB, recording.activation[i], time_in_recording)
        self._ghost.draw(self._body_poses(recording.reference_q[i]), time_in_recording)

    def draw_tip_path(self, q: np.ndarray) -> None:
        """Draws the path of the hand's tip for joint angles q (N, n_q), rad."""
        path = tube(np.array([self._tip_position(row) for row in q]), _PATH_RADIUS * self._scale)
        self.meshcat.Delete(f"{_ROOT}/tip_path")
        if path is not None:
            self.meshcat.SetObject(f"{_ROOT}/tip_path", path, PATH_COLOR)

    def draw_target(self, q: np.ndarray) -> None:
        """Draws a ball where the tip of the hand is at joint angles q (n_q,), rad."""
        self.meshcat.SetObject(f"{_ROOT}/target", Sphere(TARGET_RADIUS * self._scale), TARGET_COLOR)
        self.meshcat.SetTransform(f"{_ROOT}/target", RigidTransform(self._tip_position(q)))

    def views(self, q: np.ndarray) -> dict[str, View]:
        """The views in which the arm is visible at all joint angles q (N, n_q), rad.

        oblique: the arm and all meshes that stand still, such as a head. side: the arm, exactly along the axis of the
        last joint, where lengths are true. close: the path of the hand.
        """
        names = {body for muscle in self._arm.muscles for body, _ in muscle.points}
        bodies = [int(self._plant.GetBodyByName(name).index()) for name in names]
        path = [self._tip_position(row) for row in q]
        points = list(path)
        for row in q:
            X_WB = self._body_poses(row)
            points += [X_WB[body].translation() for body in bodies]
        direction = oblique(self._arm, self._plant, self._context)
        across = joint_axis(self._arm, self._plant, self._context)
        return {
            "oblique": self._view([*points, *self._surroundings], direction, FIELD_OF_VIEW),
            "side": self._view(points, across, _NARROW),
            "close": self._view(path, direction, FIELD_OF_VIEW, _CLOSE * self._scale),
        }

    def set_camera(self, view: View) -> None:
        """Looks at the arm in this view, in a square window."""
        center = np.array(view.center)
        distance = view.radius / np.sin(np.radians(0.5 * view.fov))
        self.meshcat.SetCamera(Meshcat.PerspectiveCamera(fov=view.fov))
        self.meshcat.SetCameraPose(center + distance * np.array(view.direction), center)

    def _view(self, points: Sequence[np.ndarray], direction: np.ndarray, fov: float, around: float = 0.0) -> View:
        """The view of points (m, in the world) and of what is around them, as far as `around` (m)."""
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        X_MW = upright(self._arm)
        return View(
            center=X_MW.multiply(0.5 * (low + high)).tolist(),
            radius=_MARGIN * (0.5 * float(np.linalg.norm(high - low)) + around),
            direction=X_MW.rotation().multiply(direction / np.linalg.norm(direction)).tolist(),
            fov=fov,
        )

    def _body_poses(self, q: np.ndarray) -> list[RigidTransform]:
        self._plant.SetPositions(self._context, q)
        return self._plant.get_body_poses_output_port().Eval(self._context)

    def _tip_position(self, q: np.ndarray) -> np.ndarray:
        self._plant.SetPositions(self._context, q)
        tip = self._plant.GetFrameByName(self._arm.tip_frame)
        return tip.CalcPoseInWorld(self._context).translation()


def _still_meshes(plant: MultibodyPlant, scene_graph: SceneGraph) -> list[np.ndarray]:
    """The corners (3,), m, in the world, of boxes around all visual meshes that cannot move."""
    inspector, X_WB = (
        scene_graph.model_inspector(),
        plant.get_body_poses_output_port().Eval(plant.CreateDefaultContext()),
    )
    corners = []
    for index in (BodyIndex(i) for i in range(plant.num_bodies())):
        body = plant.get_body(index)
        for geometry in plant.GetVisualGeometriesForBody(body) if plant.IsAnchored(body) else ():
            shape = inspector.GetShape(geometry)
            if isinstance(shape, Mesh):
                hull = shape.GetConvexHull()
                points = np.array([hull.vertex(i) for i in range(hull.num_vertices())])
                X_WG = X_WB[index] @ inspector.GetPoseInFrame(geometry)
                corners += [X_WG.multiply(point) for point in (points.min(axis=0), points.max(axis=0))]
    return corners
