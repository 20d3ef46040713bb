"""MuscleVisualizer: draws the muscles of an arm in Meshcat, colored by their activation."""

from typing import TYPE_CHECKING

from pydrake.common.value import Value
from pydrake.geometry import Meshcat
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, DiagramBuilder, LeafSystem

from drakearm.model import Arm
from drakearm.systems.muscle_drawing import MuscleDrawing

if TYPE_CHECKING:
    from drakearm.systems import HillMuscles

_REPEAT = 8  # draws, after which all colors are sent again


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

    PUBLISH_PERIOD = 1.0 / 32.0  # s: a page does not show more frames per second

    def __init__(
        self,
        arm: Arm,
        plant: MultibodyPlant,
        meshcat: Meshcat,
        path: str = "/drake/muscles",
        publish_period: float = PUBLISH_PERIOD,
    ):
        super().__init__()
        self._drawing = MuscleDrawing(meshcat, path, arm, plant, _REPEAT)
        self._activation = self.DeclareVectorInputPort("activation", len(arm.muscles))
        self._body_poses = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
        self.DeclarePeriodicPublishEvent(publish_period, 0.0, self._draw)
        self.DeclareForcedPublishEvent(self._draw)

    @staticmethod
    def AddToBuilder(
        builder: DiagramBuilder,
        plant: MultibodyPlant,
        muscles: "HillMuscles",
        meshcat: Meshcat,
        path: str = "/drake/muscles",
        name: str = "muscle_visualizer",
    ) -> "MuscleVisualizer":
        """Adds a MuscleVisualizer with a name and connects it to the plant and the muscles. path: of what it draws."""
        visualizer = MuscleVisualizer(muscles.arm, plant, meshcat, path)
        builder.AddNamedSystem(name, visualizer)
        builder.Connect(muscles.GetOutputPort("activation"), visualizer.GetInputPort("activation"))
        builder.Connect(plant.get_body_poses_output_port(), visualizer.GetInputPort("body_poses"))
        return visualizer

    def _draw(self, context: Context) -> None:
        self._drawing.draw(self._body_poses.Eval(context), self._activation.Eval(context), context.get_time())
