"""MuscleVisualizer: draws the muscles of an arm in Meshcat, colored by their activation."""

import math

import numpy as np
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.common.value import Value
from pydrake.geometry import Cylinder, Meshcat, Rgba, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, DiagramBuilder, LeafSystem

from drakearm.model import Arm
from drakearm.systems.hill_muscles import HillMuscles

_THICKNESS = 3.5e-4  # m / sqrt(N): the radius of a drawn muscle over the square root of its max_isometric_force
_SHORTEST = 1e-6  # m: a drawn length of 0 would have no normals
_RAMP = np.array(  # from slate at rest to red: even steps of lightness and hue in the Oklab space
    [
        [0.60, 0.67, 0.76],
        [0.67, 0.59, 0.64],
        [0.72, 0.50, 0.52],
        [0.76, 0.40, 0.40],
        [0.78, 0.27, 0.27],
        [0.80, 0.04, 0.10],
    ]
)


def activation_color(activation: np.ndarray) -> np.ndarray:
    """The colors (..., 3), sRGB in 0..1, of activations (...): slate at 0, red at 1."""
    at = np.linspace(0.0, 1.0, len(_RAMP))
    return np.stack([np.interp(activation, at, channel) for channel in _RAMP.T], axis=-1)


def segment_pose(start: np.ndarray, end: np.ndarray) -> tuple[RigidTransform, float]:
    """The pose of a straight piece of a muscle between two points (3,), m, and the length of the piece, m.

    The origin is at start, and z points to end. If the two points coincide, the axes are those of the parent frame.
    """
    along = end - start
    length = float(np.linalg.norm(along))
    if length == 0.0:
        return RigidTransform(start), 0.0
    return RigidTransform(RotationMatrix.MakeFromOneVector(along, 2), start), length


def upright(arm: Arm) -> RigidTransform:
    """The transform that turns the arm's world upright in Meshcat, whose z axis points up.

    Use it as in `meshcat.SetTransform("/drake", upright(arm))`. Without gravity it is the identity.
    """
    gravity = np.array(arm.gravity)
    if not gravity.any():
        return RigidTransform()
    up = -gravity / np.linalg.norm(gravity)
    axis = np.cross(up, [0.0, 0.0, 1.0])
    if not axis.any():
        axis = np.array([1.0, 0.0, 0.0])
    angle = math.acos(np.clip(up[2], -1.0, 1.0))
    return RigidTransform(AngleAxis(angle, axis / np.linalg.norm(axis)), np.zeros(3))


class MuscleDrawing:
    """The muscles of an arm as cylinders in Meshcat, which `draw` moves with the arm's bodies.

    Each straight piece of a muscle is a cylinder with a ball at its start, at the path `<path>/<muscle>/<piece>`. The
    radius is proportional to the square root of max_isometric_force, so the cross section is proportional to the force.
    """

    def __init__(self, meshcat: Meshcat, path: str, arm: Arm, plant: MultibodyPlant):
        """plant: a finalized plant with the arm's skeleton."""
        self._meshcat = meshcat
        self._muscles: list[tuple[list[str], list[tuple[int, np.ndarray]]]] = []
        resting = Rgba(*_RAMP[0])
        for muscle in arm.muscles:
            points = [(int(plant.GetBodyByName(b).index()), np.array(p)) for b, p in muscle.points]
            pieces = [f"{path}/{muscle.name}/{k}" for k in range(len(points) - 1)]
            radius = _THICKNESS * math.sqrt(muscle.max_isometric_force)
            for piece in pieces:
                meshcat.SetObject(f"{piece}/ball", Sphere(radius), resting)
                meshcat.SetObject(f"{piece}/cylinder/unit", Cylinder(radius, 1.0), resting)
                meshcat.SetTransform(f"{piece}/cylinder/unit", RigidTransform([0.0, 0.0, 0.5]))
            self._muscles.append((pieces, points))

    def draw(
        self,
        X_WB: list[RigidTransform],
        activation: np.ndarray,
        time_in_recording: float | None = None,
    ) -> None:
        """Moves the cylinders to the body poses X_WB and colors them by activation (n,).

        X_WB: in the order of BodyIndex. time_in_recording: time (s) of this frame in Meshcat's recording, if there is
        one.
        """
        colors = _linear(activation_color(activation))
        for (pieces, points), color in zip(self._muscles, colors, strict=True):
            p_W = [X_WB[body].multiply(p) for body, p in points]
            for piece, start, end in zip(pieces, p_W[:-1], p_W[1:], strict=True):
                self._draw_piece(piece, start, end, color, time_in_recording)

    def _draw_piece(
        self, piece: str, start: np.ndarray, end: np.ndarray, color: np.ndarray, time: float | None
    ) -> None:
        pose, length = segment_pose(start, end)
        self._meshcat.SetTransform(piece, pose, time)
        # Meshcat forgets the scale of a node when it sets its transform, so the cylinder has a node of its own.
        stretch = [1.0, 1.0, max(length, _SHORTEST)]
        self._meshcat.SetProperty(f"{piece}/cylinder", "scale", stretch, time)
        # Meshcat has several names for the color of a shape. This one works in a live scene and in a recording.
        for shape in (f"{piece}/ball/<object>", f"{piece}/cylinder/unit/<object>"):
            for channel, value in zip("rgb", color, strict=True):
                name = f"material.color[{channel}]"
                self._meshcat.SetProperty(shape, name, float(value), time)


def _linear(srgb: np.ndarray) -> np.ndarray:
    """Converts sRGB to linear light, which Meshcat's color properties expect (IEC 61966-2-1)."""
    return np.where(srgb > 0.04045, ((srgb + 0.055) / 1.055) ** 2.4, srgb / 12.92)


class MuscleVisualizer(LeafSystem):
    """Draws the muscles of an arm in Meshcat. Their thickness shows the strength, their color the activation.

    .. pydrake_system::

        name: MuscleVisualizer
        input_ports:
        - activation
        - body_poses
        output_ports: []

    ============ ==================== ====== ==================================================
    port         type                 unit   meaning
    ============ ==================== ====== ==================================================
    activation   vector (n)           0..1   HillMuscles' output of the same name
    body_poses   list[RigidTransform] m      X_WB, MultibodyPlant's output of the same name
    ============ ==================== ====== ==================================================

    It draws a `MuscleDrawing` every publish_period (s) and at forced publishes, and into Meshcat's recording, if one is
    being made. Drake's MeshcatVisualizer draws the skeleton.
    """

    PUBLISH_PERIOD = 1.0 / 64.0  # as MeshcatVisualizer

    def __init__(
        self,
        arm: Arm,
        plant: MultibodyPlant,
        meshcat: Meshcat,
        path: str = "/drake/muscles",
        publish_period: float = PUBLISH_PERIOD,
    ):
        super().__init__()
        self._drawing = MuscleDrawing(meshcat, path, arm, plant)
        self._activation = self.DeclareVectorInputPort("activation", len(arm.muscles))
        self._body_poses = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
        self.DeclarePeriodicPublishEvent(publish_period, 0.0, self._draw)
        self.DeclareForcedPublishEvent(self._draw)

    @staticmethod
    def AddToBuilder(
        builder: DiagramBuilder, plant: MultibodyPlant, muscles: HillMuscles, meshcat: Meshcat
    ) -> "MuscleVisualizer":
        """Adds a MuscleVisualizer and connects it to the plant and the muscles."""
        visualizer = MuscleVisualizer(muscles.arm, plant, meshcat)
        builder.AddNamedSystem("muscle_visualizer", visualizer)
        builder.Connect(muscles.GetOutputPort("activation"), visualizer.GetInputPort("activation"))
        builder.Connect(plant.get_body_poses_output_port(), visualizer.GetInputPort("body_poses"))
        return visualizer

    def _draw(self, context: Context) -> None:
        self._drawing.draw(self._body_poses.Eval(context), self._activation.Eval(context), context.get_time())
