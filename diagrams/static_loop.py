"""The closed loop without learning: static optimization drives the arm along a reference."""

from pydrake.geometry import Meshcat, SceneGraph
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource

from drakearm.diagrams.policy_loop import PolicyLoop, close_loop
from drakearm.diagrams.tracking_task import AddTrackingTask, TrackingTask
from drakearm.systems.static_optimizer import DAMPING, STIFFNESS, StaticOptimizer


def MakeStaticLoop(
    task: TrackingTask,
    *,
    stiffness: float = STIFFNESS,
    damping: float = DAMPING,
    meshcat: Meshcat | None = None,
) -> PolicyLoop:
    """The tracking task with `StaticOptimizer` in charge, which knows the load; drawn live if a Meshcat is given.

    stiffness (1/s^2) and damping (1/s): of the feedback on the tracking error.
    """
    builder = DiagramBuilder()
    scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph()) if meshcat else None
    systems = AddTrackingTask(builder, task, scene_graph)
    controller = builder.AddNamedSystem(
        "static_optimizer", StaticOptimizer(task.arm, task.load_mass, stiffness, damping)
    )
    wanted = builder.AddNamedSystem("wanted_motion", TrajectorySource(task.reference.trajectory(), 2))
    builder.Connect(systems.arm.plant.get_state_output_port(), controller.GetInputPort("arm_state"))
    builder.Connect(systems.arm.muscles.GetOutputPort("activation"), controller.GetInputPort("activation"))
    builder.Connect(wanted.get_output_port(), controller.GetInputPort("reference"))
    return close_loop(builder, "static_loop", systems, controller, scene_graph, meshcat)
