"""The closed loop of any controller that drives the arm along a reference, with recording and drawing."""

from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Meshcat, SceneGraph
from pydrake.systems.framework import Diagram, DiagramBuilder, LeafSystem
from pydrake.systems.primitives import LogVectorOutput, VectorLogSink

from drakearm.diagrams.muscle_arm import MakeSimulator
from drakearm.diagrams.tracking_task import TaskSystems
from drakearm.diagrams.visualization import AddMuscleVisualizer
from drakearm.model.recording import Recording
from drakearm.model.reference import CONTROL_STEP
from drakearm.model.skeleton import hand_motion

_OF_MUSCLES = (  # outputs of HillMuscles that are recorded
    "activation",
    "fiber_length",
    "fiber_velocity",
    "tendon_force",
    "mtu_length",
    "joint_moment",
    "fiber_power",
    "tendon_power",
    "metabolic_power",
)


@dataclass(frozen=True)
class TrackingLoop:
    """A closed-loop Diagram, its systems and its logs, which have one sample per control step."""

    diagram: Diagram
    systems: TaskSystems
    logs: dict[str, VectorLogSink]

    def Run(self, rng: np.random.Generator | None = None) -> Recording:
        """Simulates from the task's start to the end of the reference and returns the recording.

        rng: generates the noise of the start. Without it the start has no noise.
        """
        simulator = MakeSimulator(self.diagram)
        context = simulator.get_mutable_context()
        first = self.systems.Reset(context, rng).start.step
        simulator.Initialize()
        simulator.AdvanceTo(self.systems.task.reference.duration)
        logs = {name: log.FindLog(context) for name, log in self.logs.items()}
        data = {name: log.data().T.copy() for name, log in logs.items()}
        arm, t = self.systems.task.arm, logs["reward"].sample_times().copy()
        q, v = np.split(data.pop("arm_state"), 2, axis=1)
        p_WH, v_WH = hand_motion(self.systems.arm.plant, arm, q, v)
        return Recording(
            t=t,
            q=q,
            v=v,
            reference_q=self.systems.task.reference.q[first:],
            reference_v=self.systems.task.reference.v[first:],
            joint_moment=data.pop("joint_moment").reshape(len(t), len(arm.muscles), len(arm.coordinates)),
            p_WH=p_WH,
            v_WH=v_WH,
            reward=data.pop("reward")[:, 0],
            **data,
        )


def close_loop(
    builder: DiagramBuilder,
    name: str,
    systems: TaskSystems,
    controller: LeafSystem,
    scene_graph: SceneGraph | None,
    meshcat: Meshcat | None,
) -> TrackingLoop:
    """Connects a controller's output `excitation` to the muscles, adds logs and drawing, and builds the Diagram.

    name: of the Diagram. scene_graph, meshcat: for drawing; give both or none. The inputs of the controller must be
    connected already.
    """
    muscles, excitation = systems.arm.muscles, controller.GetOutputPort("excitation")
    builder.Connect(excitation, systems.excitation)
    ports = {
        "arm_state": systems.arm.plant.get_state_output_port(),
        "reward": systems.reward.GetOutputPort("reward"),
        "excitation": excitation,
    } | {name: muscles.GetOutputPort(name) for name in _OF_MUSCLES}
    logs = {name: LogVectorOutput(port, builder, CONTROL_STEP) for name, port in ports.items()}
    if meshcat:
        AddMuscleVisualizer(builder, systems.arm, meshcat, scene_graph)
    diagram = builder.Build()
    diagram.set_name(name)
    return TrackingLoop(diagram, systems, logs)
