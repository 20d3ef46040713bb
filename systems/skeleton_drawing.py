"""The visual shapes of a plant's bodies in Meshcat, in their own colors or as a ghost."""

from pydrake.geometry import Mesh, Meshcat, Rgba, SceneGraph, Shape
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, RigidBody

from drakearm.model import Arm
from drakearm.model.skeleton import add_skeleton
from drakearm.model.skeleton_file import LOAD
from drakearm.systems.plain_bones import plain_bones

_PLAIN = Rgba(0.9, 0.9, 0.9, 1.0)
_BONE = Rgba(0.93, 0.89, 0.80, 1.0)
_GHOST_SCALE = [1.35, 1.35, 1.02]  # twice across a capsule, then along it
_BACK_SIDE = 1.0  # three.js: draws only the back side of each face
_OPAQUE = 0.99  # alpha


class SkeletonDrawing:
    """The shapes of a plant's bodies, which `draw` moves. The shapes of body b are at `<path>/b`."""

    def __init__(
        self,
        meshcat: Meshcat,
        path: str,
        plant: MultibodyPlant,
        scene_graph: SceneGraph,
        ghost: Rgba | None = None,
    ):
        """plant: finalized, and registered as a source of the scene_graph.

        ghost: if given, the shapes are drawn as a ghost in this color. Only the bodies that move are drawn, without a
        load. Spheres, capsules and the like are slightly thicker, so that a ghost at the same place as the body looks
        like a rim.

        Of translucent shapes, such as a skin or a ghost, only the far side is drawn: it is never in front of what is
        inside.
        """
        self._meshcat = meshcat
        self._bodies: list[tuple[int, str]] = []
        for i in range(plant.num_bodies()):
            body = plant.get_body(BodyIndex(i))
            shapes = _shapes(plant, scene_graph, body)
            if not shapes or (ghost is not None and (plant.IsAnchored(body) or body.name() == LOAD)):
                continue
            self._bodies.append((i, f"{path}/{body.name()}"))
            for k, (X_BG, shape, color) in enumerate(shapes):
                part = f"{path}/{body.name()}/{k}"
                meshcat.SetTransform(part, X_BG)
                meshcat.SetObject(f"{part}/shape", shape, ghost or color)
                if ghost is not None and not isinstance(shape, Mesh):
                    meshcat.SetProperty(f"{part}/shape", "scale", _GHOST_SCALE)
                if (ghost or color).a() < _OPAQUE:
                    meshcat.SetProperty(f"{part}/shape/<object>", "material.side", _BACK_SIDE)
                    meshcat.SetProperty(f"{part}/shape/<object>", "material.depthWrite", False)

    def draw(self, X_WB: list[RigidTransform], time_in_recording: float | None = None) -> None:
        """Moves the shapes to body poses X_WB, in order of BodyIndex.

        time_in_recording: s. If Meshcat is recording, it stores this frame at this time.
        """
        for index, path in self._bodies:
            self._meshcat.SetTransform(path, X_WB[index], time_in_recording)


def drawn_skeleton(arm: Arm, load_mass: float = 0.0) -> tuple[MultibodyPlant, SceneGraph]:
    """A finalized plant of an arm's skeleton with a load (kg), whose shapes are in a SceneGraph: for drawing."""
    plant, scene_graph = MultibodyPlant(time_step=0.0), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    add_skeleton(plant, arm, load_mass)
    plant.Finalize()
    return plant, scene_graph


def _shapes(
    plant: MultibodyPlant, scene_graph: SceneGraph, body: RigidBody
) -> list[tuple[RigidTransform, Shape, Rgba]]:
    """The shapes of a body, with their poses X_BG and colors: simple ones where the skeleton's file has none."""
    inspector, shapes = scene_graph.model_inspector(), []
    for geometry in plant.GetVisualGeometriesForBody(body):
        properties = inspector.GetIllustrationProperties(geometry)
        color = properties.GetPropertyOrDefault("phong", "diffuse", _PLAIN)
        shapes.append((inspector.GetPoseInFrame(geometry), inspector.GetShape(geometry), color))
    return shapes or [(X_BG, shape, _BONE) for X_BG, shape in plain_bones(plant, body)]
