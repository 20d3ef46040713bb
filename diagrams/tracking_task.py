"""The Diagram of a task: arm, reference, senses and reward. The controller, which decides excitations, is not in it."""

from dataclasses import dataclass

import numpy as np
from pydrake.geometry import SceneGraph
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, InputPort
from pydrake.systems.primitives import Demultiplexer, PassThrough, TrajectorySource

from drakearm.diagrams.muscle_arm import AddMuscleArm, MuscleArm
from drakearm.model.reference import CONTROL_STEP
from drakearm.systems.proprioception import Proprioception
from drakearm.systems.tracking_reward import TrackingReward
from drakearm.task import StartState, TrackingTask


@dataclass(frozen=True)
class TaskSystems:
    """The systems of a task in a Diagram. Connect the excitations of a controller to the port `excitation`."""

    task: TrackingTask
    arm: MuscleArm
    excitation: InputPort
    proprioception: Proprioception
    reward: TrackingReward

    def StartState(self, rng: np.random.Generator | None = None) -> StartState:
        """A start state of the task, clamped to the joint ranges. Without rng it has no noise."""
        plant, start = self.arm.plant, self.task.start(self.task.reference, rng)
        return start._replace(q=np.clip(start.q, plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()))

    def Reset(self, root_context: Context, rng: np.random.Generator | None = None) -> StartState:
        """Draws a start state, sets the arm and the time to it, and returns it. The time is that on the reference."""
        start = self.StartState(rng)
        root_context.SetTime(start.step * CONTROL_STEP)
        self.arm.SetState(root_context, start.q, np.broadcast_to(start.v, len(start.q)), start.activation)
        return start


def AddTrackingTask(builder: DiagramBuilder, task: TrackingTask, scene_graph: SceneGraph | None = None) -> TaskSystems:
    """Adds arm, reference, senses and reward to a builder and connects them.

    The task's start is also the start of Drake's own contexts: the default context has the posture without noise, and
    SetRandomContext draws a posture with noise (`Start.random_posture`).
    """
    arm = AddMuscleArm(builder, task.arm, load_mass=task.load_mass, scene_graph=scene_graph, obstacle=task.obstacle)
    arm.plant.SetDefaultPositions(task.start(task.reference, None).q)
    for name, angle in zip(task.arm.coordinates, task.start.random_posture(task.reference), strict=True):
        arm.plant.GetMutableJointByName(name).set_random_angle_distribution(angle)

    n, n_preview = len(task.arm.muscles), len(task.arm.coordinates) * len(task.lookahead)
    reference = builder.AddNamedSystem("reference", TrajectorySource(task.reference.preview_trajectory(), 1))
    preview = builder.AddNamedSystem("preview", TrajectorySource(task.reference.preview_trajectory(task.lookahead), 1))
    previews = builder.AddNamedSystem("preview_q_and_v", Demultiplexer(2 * n_preview, n_preview))
    builder.Connect(preview.get_output_port(), previews.get_input_port())
    signals = {
        "arm_state": arm.plant.get_state_output_port(),
        "arm_acceleration": arm.plant.get_generalized_acceleration_output_port(),
        "reference": reference.get_output_port(),
        "preview_q": previews.get_output_port(0),
        "preview_v": previews.get_output_port(1),
    } | {
        name: arm.muscles.GetOutputPort(name)
        for name in ("activation", "fiber_length", "fiber_velocity", "tendon_force")
    }
    proprioception = builder.AddNamedSystem("proprioception", Proprioception(task))
    reward = builder.AddNamedSystem("tracking_reward", TrackingReward(task))
    excitation = arm.muscles.GetInputPort("excitation")
    if "excitation" in (*proprioception.observation.reads, *task.reward.reads):
        shared = builder.AddNamedSystem("excitation", PassThrough(n))
        builder.Connect(shared.get_output_port(), excitation)
        excitation, signals["excitation"] = shared.get_input_port(), shared.get_output_port()
    for system in (proprioception, reward):
        for i in range(system.num_input_ports()):
            port = system.get_input_port(i)
            builder.Connect(signals[port.get_name()], port)
    return TaskSystems(task, arm, excitation, proprioception, reward)


def MakeTrackingTask(task: TrackingTask) -> tuple[Diagram, TaskSystems]:
    """A Diagram with the ports that `DiagramEnv` and pydrake.gym expect, and its systems.

    Input: actions, which are the excitations (n,). Outputs: observations (`Proprioception`) and reward (1,). Further
    outputs, for information only: arm_state (2 n_q,), tracking_error (n_q,) and activation (n,).
    """
    builder = DiagramBuilder()
    systems = AddTrackingTask(builder, task)
    builder.ExportInput(systems.excitation, "actions")
    builder.ExportOutput(systems.proprioception.get_output_port(), "observations")
    builder.ExportOutput(systems.reward.GetOutputPort("reward"), "reward")
    builder.ExportOutput(systems.arm.plant.get_state_output_port(), "arm_state")
    builder.ExportOutput(systems.reward.GetOutputPort("tracking_error"), "tracking_error")
    builder.ExportOutput(systems.arm.muscles.GetOutputPort("activation"), "activation")
    diagram = builder.Build()
    diagram.set_name("tracking_task")
    return diagram, systems
