"""The closed loop of any controller that drives the arm along a reference, with recording and drawing."""

from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Meshcat, SceneGraph
from pydrake.systems.framework import Diagram, DiagramBuilder, LeafSystem

from drakearm.diagrams.muscle_arm import MakeSimulator
from drakearm.diagrams.recorder import AddRecorder, Recorder
from drakearm.diagrams.tracking_task import TaskSystems
from drakearm.diagrams.visualization import AddMuscleVisualizer
from drakearm.model.recording import Recording


@dataclass(frozen=True)
class TrackingLoop:
    """A closed-loop Diagram, its systems and its recorder."""

    diagram: Diagram
    systems: TaskSystems
    recorder: Recorder

    def Run(self, rng: np.random.Generator | None = None) -> Recording:
        """Simulates from the task's start to the end of the reference and returns the recording.

        rng: generates the noise of the start. Without it the start has no noise.
        """
        simulator = MakeSimulator(self.diagram)
        context = simulator.get_mutable_context()
        self.systems.Reset(context, rng)
        simulator.Initialize()
        simulator.AdvanceTo(self.systems.task.reference.duration)
        return self.recorder.Recording(context, self.systems.task.reference)


def close_loop(
    builder: DiagramBuilder,
    name: str,
    systems: TaskSystems,
    controller: LeafSystem,
    scene_graph: SceneGraph | None,
    meshcat: Meshcat | None,
) -> TrackingLoop:
    """Connects a controller's output `excitation` to the muscles, adds a recorder and drawing, and builds the Diagram.

    name: of the Diagram. scene_graph, meshcat: for drawing; give both or none. The inputs of the controller must be
    connected already.
    """
    excitation = controller.GetOutputPort("excitation")
    builder.Connect(excitation, systems.excitation)
    reward = systems.reward.GetOutputPort("reward")
    recorder = AddRecorder(builder, systems.arm, excitation=excitation, reward=reward)
    if meshcat:
        AddMuscleVisualizer(builder, systems.arm, meshcat, scene_graph)
    diagram = builder.Build()
    diagram.set_name(name)
    return TrackingLoop(diagram, systems, recorder)
