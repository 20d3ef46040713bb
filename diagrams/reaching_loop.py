"""The closed loop of an arm that a policy moves to wherever the input port `target` says."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Meshcat, SceneGraph
from pydrake.systems.framework import Context, Diagram, DiagramBuilder

from drakearm.diagrams.perturbation import Perturbation
from drakearm.diagrams.tracking_task import AddTrackingTask, TaskSystems
from drakearm.diagrams.visualization import AddMuscleVisualizer
from drakearm.model.reference import CONTROL_STEP
from drakearm.systems.policy_controller import Policy, PolicyController
from drakearm.systems.reach_source import Planner, ReachSource
from drakearm.task import TrackingTask


@dataclass(frozen=True)
class ReachingLoop:
    """A Diagram with the input port `target` and the output port `arm_state`, and its systems."""

    diagram: Diagram
    systems: TaskSystems
    source: ReachSource

    def Reset(self, root_context: Context, rng: np.random.Generator | None = None) -> None:
        """Sets the arm to the start of its task: at rest, at the first posture. rng: see `TaskSystems.Reset`."""
        self.systems.Reset(root_context, rng)


def MakeReachingLoop(
    task: TrackingTask,
    policy: Policy,
    planner: Planner,
    target: np.ndarray,
    meshcat: Meshcat | None = None,
    *,
    perturbations: Sequence[Perturbation] = (),
    variable_load: bool = False,
) -> ReachingLoop:
    """An arm with a policy (observation to excitations) that follows what `ReachSource` plans; drawn live in Meshcat.

    task: its senses, start and load; its reference is where the arm rests before the first target. planner, target: see
    `ReachSource`. perturbations: what disturbs the arm without the policy's knowledge. variable_load: whether
    `systems.arm.SetBody` can change the load during a simulation.
    """
    builder = DiagramBuilder()
    scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph()) if meshcat else None
    source = builder.AddNamedSystem("reference", ReachSource(planner, task.reference, target, task.lookahead))
    systems = AddTrackingTask(builder, task, scene_graph, perturbations, varies=variable_load or None, reference=source)
    builder.ExportInput(source.GetInputPort("target"), "target")
    builder.Connect(systems.arm.plant.get_state_output_port(), source.GetInputPort("arm_state"))
    observation = systems.proprioception.get_output_port()
    controller = builder.AddNamedSystem(
        "policy", PolicyController(policy, observation.size(), len(task.arm.muscles), CONTROL_STEP)
    )
    builder.Connect(observation, controller.GetInputPort("observation"))
    builder.Connect(controller.GetOutputPort("excitation"), systems.excitation)
    builder.ExportOutput(systems.arm.plant.get_state_output_port(), "arm_state")
    if meshcat:
        AddMuscleVisualizer(builder, systems.arm, meshcat, scene_graph)
    diagram = builder.Build()
    diagram.set_name("reaching_loop")
    return ReachingLoop(diagram, systems, source)
