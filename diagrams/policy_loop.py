"""The closed loop with a policy, which drives the arm along a reference."""

from collections.abc import Sequence

from pydrake.geometry import Meshcat, SceneGraph
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams.perturbation import Perturbation
from drakearm.diagrams.tracking_loop import TrackingLoop, close_loop
from drakearm.diagrams.tracking_task import AddTrackingTask
from drakearm.model.reference import CONTROL_STEP
from drakearm.systems.policy_controller import Policy, PolicyController
from drakearm.task import TrackingTask


def MakePolicyLoop(
    task: TrackingTask,
    policy: Policy,
    meshcat: Meshcat | None = None,
    *,
    perturbations: Sequence[Perturbation] = (),
) -> TrackingLoop:
    """The tracking task controlled by a policy (observation to excitations); drawn live if a Meshcat is given.

    perturbations: what disturbs the arm and its senses without the policy's knowledge.
    """
    builder = DiagramBuilder()
    scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph()) if meshcat else None
    systems = AddTrackingTask(builder, task, scene_graph, perturbations)
    observation = systems.proprioception.get_output_port()
    controller = builder.AddNamedSystem(
        "policy", PolicyController(policy, observation.size(), len(task.arm.muscles), CONTROL_STEP)
    )
    builder.Connect(observation, controller.GetInputPort("observation"))
    return close_loop(builder, "policy_loop", systems, controller, scene_graph, meshcat)
