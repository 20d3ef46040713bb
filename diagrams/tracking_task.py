"""The Diagram of a task: arm, reference, senses and reward. The controller, which decides excitations, is not in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import SceneGraph
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, InputPort, OutputPort
from pydrake.systems.primitives import Demultiplexer, PassThrough, TrajectorySource

from drakearm.diagrams.muscle_arm import AddMuscleArm, MuscleArm
from drakearm.diagrams.perturbation import BeginsRun, Perturbation, perturb_plant
from drakearm.model.reference import CONTROL_STEP
from drakearm.systems.proprioception import Proprioception
from drakearm.systems.tracking_reward import TrackingReward
from drakearm.task import Start, StartState, TrackingTask

_OF_MUSCLES = ("activation", "fiber_length", "fiber_velocity", "tendon_force")
_ALWAYS_SENSED = ("arm_state", "activation")  # also by controllers that do not get the observation


@dataclass(frozen=True)
class TaskSystems:
    """The systems of a task in a Diagram. Connect the excitations of a controller to the port `excitation`.

    task: as the controller knows it. arm, start: as they are, with the perturbations of load, strength and start.
    sensed: what the controller gets of its body, by the names of signals; at least arm_state and activation. to_begin:
    what is prepared for each run.
    """

    task: TrackingTask
    arm: MuscleArm
    start: Start
    excitation: InputPort
    sensed: dict[str, OutputPort]
    proprioception: Proprioception
    reward: TrackingReward
    to_begin: tuple[BeginsRun, ...]

    def StartState(self, rng: np.random.Generator | None = None) -> StartState:
        """A start state of the task, clamped to the joint ranges. Without rng it has no noise."""
        plant, start = self.arm.plant, self.start(self.task.reference, rng)
        return start._replace(q=np.clip(start.q, plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()))

    def Reset(self, root_context: Context, rng: np.random.Generator | None = None) -> StartState:
        """Draws a start state, sets the arm and the time to it, and returns it. The time is that on the reference.

        rng: what all noise comes from, of the start and of perturbations. Without it there is no noise.
        """
        start = self.StartState(rng)
        root_context.SetTime(start.step * CONTROL_STEP)
        self.arm.SetState(root_context, start.q, np.broadcast_to(start.v, len(start.q)), start.activation)
        for system in self.to_begin:
            system.Begin(root_context, rng)
        return start


def AddTrackingTask(
    builder: DiagramBuilder,
    task: TrackingTask,
    scene_graph: SceneGraph | None = None,
    perturbations: Sequence[Perturbation] = (),
) -> TaskSystems:
    """Adds arm, reference, senses and reward to a builder and connects them.

    perturbations: what disturbs the arm and its senses. The observation and the reward stay those of the task.

    The task's start is also the start of Drake's own contexts: the default context has the posture without noise, and
    SetRandomContext draws a posture with noise (`Start.random_posture`).
    """
    moved = task
    for perturbation in perturbations:
        moved = perturbation.perturb_task(moved)
    arm = AddMuscleArm(builder, moved.arm, load_mass=moved.load_mass, scene_graph=scene_graph, obstacle=task.obstacle)
    arm.plant.SetDefaultPositions(moved.start(task.reference, None).q)
    for name, angle in zip(task.arm.coordinates, moved.start.random_posture(task.reference), strict=True):
        arm.plant.GetMutableJointByName(name).set_random_angle_distribution(angle)

    n, n_preview = len(task.arm.muscles), len(task.arm.coordinates) * len(task.lookahead)
    reference = builder.AddNamedSystem("reference", TrajectorySource(task.reference.preview_trajectory(), 1))
    preview = builder.AddNamedSystem("preview", TrajectorySource(task.reference.preview_trajectory(task.lookahead), 1))
    previews = builder.AddNamedSystem("preview_q_and_v", Demultiplexer(2 * n_preview, n_preview))
    builder.Connect(preview.get_output_port(), previews.get_input_port())
    body = {"arm_state": arm.plant.get_state_output_port()}
    body |= {name: arm.muscles.GetOutputPort(name) for name in _OF_MUSCLES}
    signals = body | {
        "arm_acceleration": arm.plant.get_generalized_acceleration_output_port(),
        "reference": reference.get_output_port(),
        "preview_q": previews.get_output_port(0),
        "preview_v": previews.get_output_port(1),
    }
    proprioception = builder.AddNamedSystem("proprioception", Proprioception(task))
    reward = builder.AddNamedSystem("tracking_reward", TrackingReward(task))
    excitation = arm.muscles.GetInputPort("excitation")
    if perturbations or "excitation" in (*proprioception.observation.reads, *task.reward.reads):
        shared = builder.AddNamedSystem("excitation", PassThrough(n))
        perturbed = signals["excitation"] = shared.get_output_port()
        for perturbation in perturbations:
            perturbed = perturbation.perturb_excitation(builder, perturbed)
        builder.Connect(perturbed, excitation)
        excitation = shared.get_input_port()
    sensed = {name: body[name] for name in body if name in (*proprioception.observation.reads, *_ALWAYS_SENSED)}
    for perturbation in perturbations:
        sensed = {name: perturbation.perturb_sense(builder, name, signal) for name, signal in sensed.items()}
    if perturbations:
        perturb_plant(builder, arm, perturbations)
    for system, available in ((proprioception, signals | sensed), (reward, signals)):
        for i in range(system.num_input_ports()):
            port = system.get_input_port(i)
            builder.Connect(available[port.get_name()], port)
    to_begin = tuple(system for system in builder.GetSystems() if isinstance(system, BeginsRun))
    return TaskSystems(task, arm, moved.start, excitation, sensed, proprioception, reward, to_begin)


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
