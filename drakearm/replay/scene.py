"""The scene of a replay in its own Meshcat: the arm with its muscles, and the reference as a ghost."""

from itertools import pairwise

import numpy as np
from pydrake.geometry import Cylinder, Meshcat, MeshcatParams, Rgba, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model import Arm
from drakearm.model.obstacle import Obstacle, add_obstacle
from drakearm.model.recording import Recording
from drakearm.model.skeleton import add_skeleton
from drakearm.replay.skeleton_drawing import SkeletonDrawing
from drakearm.systems.muscle_visualizer import MuscleDrawing, segment_pose, upright

GHOST_COLOR = Rgba(0.0, 0.58, 0.55, 0.25)
PATH_COLOR = Rgba(0.95, 0.55, 0.05, 1.0)

_ROOT = "/drakearm"
_PATH_RADIUS = 0.002  # m
_VIEW = np.array([0.35, 0.12, 1.0])  # to the camera, in the world: right, slightly to the front and up
_FIELD_OF_VIEW = 30.0  # degrees
_MARGIN = 1.15  # the distance of the camera over the smallest one that shows the whole arm


class ReplayScene:
    """An arm in its own Meshcat, which closes when the scene is deleted. `draw` shows the arm as in a recording."""

    def __init__(self, arm: Arm, load_mass: float = 0.0, obstacle: Obstacle | None = None):
        """load_mass: kg, in the hand."""
        self._arm = arm
        self._plant = MultibodyPlant(time_step=0.0)
        scene_graph = SceneGraph()
        self._plant.RegisterAsSourceForSceneGraph(scene_graph)
        add_skeleton(self._plant, arm, load_mass)
        if obstacle is not None:
            add_obstacle(self._plant, obstacle)
        self._plant.Finalize()
        self._context = self._plant.CreateDefaultContext()

        self.meshcat = Meshcat(MeshcatParams(host="localhost", port=0))  # any free port
        self._set_stage()
        self._skeleton = SkeletonDrawing(self.meshcat, f"{_ROOT}/arm", self._plant, scene_graph)
        self._ghost = SkeletonDrawing(self.meshcat, f"{_ROOT}/reference", self._plant, scene_graph, GHOST_COLOR)
        self._muscles = MuscleDrawing(self.meshcat, f"{_ROOT}/muscles", arm, self._plant)

    def _set_stage(self) -> None:
        for path in ("/Grid", "/Axes"):
            self.meshcat.SetProperty(path, "visible", False)
        self.meshcat.SetProperty("/Background/<object>", "top_color", [1.0, 1.0, 1.0])
        self.meshcat.SetProperty("/Background/<object>", "bottom_color", [0.90, 0.92, 0.95])
        self.meshcat.SetProperty("/Lights/AmbientLight/<object>", "intensity", 1.0)
        self.meshcat.SetTransform(_ROOT, upright(self._arm))

    def draw(self, recording: Recording, i: int, time_in_recording: float | None = None) -> None:
        """Draws sample i. If Meshcat is recording, it stores this frame at time_in_recording (s)."""
        X_WB = self._body_poses(recording.q[i])
        self._skeleton.draw(X_WB, time_in_recording)
        self._muscles.draw(X_WB, recording.activation[i], time_in_recording)
        self._ghost.draw(self._body_poses(recording.reference_q[i]), time_in_recording)

    def draw_tip_path(self, q: np.ndarray) -> None:
        """Draws the path of the hand's tip for joint angles q (N, n_q), rad."""
        points = [self._tip_position(row) for row in q]
        for i, (start, end) in enumerate(pairwise(points)):  # cylinders, because lines would be one pixel wide
            pose, length = segment_pose(start, end)
            piece = f"{_ROOT}/tip_path/{i}"
            if length > 0.0:
                self.meshcat.SetTransform(piece, pose)
                self.meshcat.SetTransform(f"{piece}/line", RigidTransform([0.0, 0.0, 0.5 * length]))
                self.meshcat.SetObject(f"{piece}/line", Cylinder(_PATH_RADIUS, length), PATH_COLOR)

    def frame_camera(self, q: np.ndarray) -> None:
        """Points the camera so that the whole arm is visible at all joint angles q (N, n_q), rad."""
        names = {body for muscle in self._arm.muscles for body, _ in muscle.points}
        bodies = [int(self._plant.GetBodyByName(name).index()) for name in names]
        points = [self._tip_position(row) for row in q]
        for row in q:
            X_WB = self._body_poses(row)
            points += [X_WB[body].translation() for body in bodies]
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        target = 0.5 * (low + high)
        radius = 0.5 * float(np.linalg.norm(high - low))
        distance = _MARGIN * radius / np.sin(np.radians(0.5 * _FIELD_OF_VIEW))
        camera = target + distance * _VIEW / np.linalg.norm(_VIEW)
        X_MW = upright(self._arm)
        self.meshcat.SetCamera(Meshcat.PerspectiveCamera(fov=_FIELD_OF_VIEW))
        self.meshcat.SetCameraPose(X_MW.multiply(camera), X_MW.multiply(target))

    def _body_poses(self, q: np.ndarray) -> list[RigidTransform]:
        self._plant.SetPositions(self._context, q)
        return self._plant.get_body_poses_output_port().Eval(self._context)

    def _tip_position(self, q: np.ndarray) -> np.ndarray:
        self._plant.SetPositions(self._context, q)
        tip = self._plant.GetFrameByName(self._arm.tip_frame)
        return tip.CalcPoseInWorld(self._context).translation()
