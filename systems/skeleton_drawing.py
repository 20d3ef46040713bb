"""The visual shapes of a plant's bodies in Meshcat, in their own colors or as a ghost."""

from pydrake.geometry import Meshcat, Rgba, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex

from drakearm.model.skeleton_file import LOAD

_PLAIN = Rgba(0.9, 0.9, 0.9, 1.0)
_GHOST_SCALE = [1.35, 1.35, 1.02]  # twice across a capsule, then along it
_BACK_SIDE = 1.0  # three.js: draws only the back side of each face


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
        load, slightly thicker, and only the far side of their surfaces. So a ghost at the same place as the body looks
        like a rim.
        """
        self._meshcat = meshcat
        self._bodies: list[tuple[int, str]] = []
        inspector = scene_graph.model_inspector()
        for i in range(plant.num_bodies()):
            body = plant.get_body(BodyIndex(i))
            geometries = plant.GetVisualGeometriesForBody(body)
            if not geometries or (ghost is not None and (plant.IsAnchored(body) or body.name() == LOAD)):
                continue
            self._bodies.append((i, f"{path}/{body.name()}"))
            for k, geometry in enumerate(geometries):
                part = f"{path}/{body.name()}/{k}"
                properties = inspector.GetIllustrationProperties(geometry)
                color = properties.GetPropertyOrDefault("phong", "diffuse", _PLAIN)
                meshcat.SetTransform(part, inspector.GetPoseInFrame(geometry))
                meshcat.SetObject(f"{part}/shape", inspector.GetShape(geometry), ghost or color)
                if ghost is not None:
                    meshcat.SetProperty(f"{part}/shape", "scale", _GHOST_SCALE)
                    meshcat.SetProperty(f"{part}/shape/<object>", "material.side", _BACK_SIDE)

    def draw(self, X_WB: list[RigidTransform], time_in_recording: float | None = None) -> None:
        """Moves the shapes to body poses X_WB, in order of BodyIndex.

        time_in_recording: s. If Meshcat is recording, it stores this frame at this time.
        """
        for index, path in self._bodies:
            self._meshcat.SetTransform(path, X_WB[index], time_in_recording)
