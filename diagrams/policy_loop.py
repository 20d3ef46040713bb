"""The closed loop: a policy, or another controller, that drives the arm along a reference, recorded and drawn."""

from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Meshcat, MeshcatVisualizer, SceneGraph
from pydrake.systems.framework import Diagram, DiagramBuilder, LeafSystem
from pydrake.systems.primitives import LogVectorOutput, VectorLogSink

from drakearm.diagrams.muscle_arm import MakeSimulator
from drakearm.diagrams.tracking_task import AddTrackingTask, TaskSystems, TrackingTask
from drakearm.model.recording import Recording
from drakearm.model.reference import CONTROL_STEP
from drakearm.systems.muscle_visualizer import MuscleVisualizer, upright
from drakearm.systems.policy_controller import Policy, PolicyController


@dataclass(frozen=True)
class PolicyLoop:
    """A closed-loop Diagram, its systems and its logs, which sample the control steps."""

    diagram: Diagram
    systems: TaskSystems
    logs: dict[str, VectorLogSink]

    def Run(self, rng: np.random.Generator | None = None) -> Recording:
        """Simulates the reference from start to end and returns what happened. rng: draws the start noise, if given."""
        simulator = MakeSimulator(self.diagram)
        context = simulator.get_mutable_context()
        self.systems.Reset(context, rng)
        simulator.Initialize()
        simulator.AdvanceTo(self.systems.task.reference.duration)
        logs = {name: log.FindLog(context) for name, log in self.logs.items()}
        data = {name: log.data().T.copy() for name, log in logs.items()}
        n_q = len(self.systems.task.arm.coordinates)
        arm_state = data.pop("arm_state")
        return Recording(
            t=logs["reward"].sample_times().copy(),
            q=arm_state[:, :n_q],
            v=arm_state[:, n_q:],
            reference_q=self.systems.task.reference.q,
            reference_v=self.systems.task.reference.v,
            reward=data.pop("reward")[:, 0],
            **data,
        )


def MakePolicyLoop(task: TrackingTask, policy: Policy, meshcat: Meshcat | None = None) -> PolicyLoop:
    """The tracking task with a policy (observation to excitations) in charge; drawn live if a Meshcat is given."""
    builder = DiagramBuilder()
    scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph()) if meshcat else None
    systems = AddTrackingTask(builder, task, scene_graph)
    observation = systems.proprioception.get_output_port()
    controller = builder.AddNamedSystem(
        "policy", PolicyController(policy, observation.size(), len(task.arm.muscles), CONTROL_STEP)
    )
    builder.Connect(observation, controller.GetInputPort("observation"))
    return close_loop(builder, "policy_loop", systems, controller, scene_graph, meshcat)


def close_loop(
    builder: DiagramBuilder,
    name: str,
    systems: TaskSystems,
    controller: LeafSystem,
    scene_graph: SceneGraph | None,
    meshcat: Meshcat | None,
) -> PolicyLoop:
    """Lets a controller's output `excitation` drive the muscles, logs and draws, and builds the Diagram of that name.

    scene_graph and meshcat: both or none. The controller's inputs are connected already.
    """
    muscles, excitation = systems.arm.muscles, controller.GetOutputPort("excitation")
    builder.Connect(excitation, muscles.GetInputPort("excitation"))
    ports = {
        "arm_state": systems.arm.plant.get_state_output_port(),
        "reward": systems.reward.GetOutputPort("reward"),
        "excitation": excitation,
    } | {name: muscles.GetOutputPort(name) for name in ("activation", "fiber_length", "fiber_velocity", "tendon_force")}
    logs = {name: LogVectorOutput(port, builder, CONTROL_STEP) for name, port in ports.items()}
    if meshcat:
        MeshcatVisualizer.AddToBuilder(builder, scene_graph, meshcat)
        MuscleVisualizer.AddToBuilder(builder, systems.arm.plant, muscles, meshcat)
        meshcat.SetTransform("/drake", upright(systems.task.arm))
    diagram = builder.Build()
    diagram.set_name(name)
    return PolicyLoop(diagram, systems, logs)
