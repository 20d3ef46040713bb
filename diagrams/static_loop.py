"""The closed loop with static optimization, which drives the arm along a reference without learning."""

from pydrake.geometry import Meshcat, SceneGraph
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource

from drakearm.diagrams.tracking_loop import TrackingLoop, close_loop
from drakearm.diagrams.tracking_task import AddTrackingTask
from drakearm.model.feedback import Feedback
from drakearm.systems.static_optimizer import FEEDBACK, StaticOptimizer
from drakearm.task import TrackingTask


def MakeStaticLoop(
    task: TrackingTask,
    *,
    feedback: Feedback = FEEDBACK,
    meshcat: Meshcat | None = None,
) -> TrackingLoop:
    """The tracking task controlled by `StaticOptimizer`, which knows the load; drawn live if a Meshcat is given.

    feedback: how accelerations respond to the tracking error.
    """
    builder = DiagramBuilder()
    scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph()) if meshcat else None
    systems = AddTrackingTask(builder, task, scene_graph)
    controller = builder.AddNamedSystem("static_optimizer", StaticOptimizer(task.arm, task.load_mass, feedback))
    desired = builder.AddNamedSystem("desired_motion", TrajectorySource(task.reference.trajectory(), 2))
    builder.Connect(systems.arm.plant.get_state_output_port(), controller.GetInputPort("arm_state"))
    builder.Connect(systems.arm.muscles.GetOutputPort("activation"), controller.GetInputPort("activation"))
    builder.Connect(desired.get_output_port(), controller.GetInputPort("reference"))
    return close_loop(builder, "static_loop", systems, controller, scene_graph, meshcat)
