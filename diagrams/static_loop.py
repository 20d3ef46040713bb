"""The closed loop with static optimization, which drives the arm along a reference without learning."""

from collections.abc import Sequence

from pydrake.geometry import Meshcat, SceneGraph
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource

from drakearm.diagrams.perturbation import Perturbation
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
    perturbations: Sequence[Perturbation] = (),
) -> TrackingLoop:
    """The tracking task controlled by `StaticOptimizer`, which knows the task's load; drawn live if a Meshcat is given.

    Where the muscles are too weak, the joints have the priorities of the task's reward. feedback: how accelerations
    respond to the tracking error. perturbations: what disturbs the arm and its senses without the controller's
    knowledge.
    """
    builder = DiagramBuilder()
    scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph()) if meshcat else None
    systems = AddTrackingTask(builder, task, scene_graph, perturbations)
    controller = builder.AddNamedSystem(
        "static_optimizer", StaticOptimizer(task.arm, task.load_mass, feedback, priority=task.reward.priority(task.arm))
    )
    desired = builder.AddNamedSystem("desired_motion", TrajectorySource(task.reference.trajectory(), 2))
    builder.Connect(systems.sensed["arm_state"], controller.GetInputPort("arm_state"))
    builder.Connect(systems.sensed["activation"], controller.GetInputPort("activation"))
    builder.Connect(desired.get_output_port(), controller.GetInputPort("reference"))
    return close_loop(builder, "static_loop", systems, controller, scene_graph, meshcat)
