"""The Diagram of a task: arm, reference, senses and reward. The controller, which decides excitations, is not in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Meshcat, SceneGraph
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, InputPort, OutputPort
from pydrake.systems.primitives import Adder, ConstantVectorSource, Gain, LinearSystem, PassThrough

from drakearm.diagrams.muscle_arm import AddMuscleArm, MuscleArm
from drakearm.diagrams.perturbation import BeginsRun, Perturbation, perturb_plant
from drakearm.diagrams.visualization import AddMuscleVisualizer
from drakearm.model.reference import CONTROL_STEP
from drakearm.systems.delay_line import DelayLine
from drakearm.systems.excitation_noise import ExcitationNoise
from drakearm.systems.proprioception import Proprioception
from drakearm.systems.reference_source import ReferenceSource
from drakearm.systems.tracking_reward import TrackingReward
from drakearm.task import Episode, TrackingTask, signal_size
from drakearm.task.episode import LONGEST_STEPS
from drakearm.task.signals import OF_BODY, RECENT, REMEMBERED

_ALWAYS_SENSED = ("arm_state", "activation")  # also by controllers that do not get the observation


@dataclass(frozen=True)
class TaskSystems:
    """The systems of a task in a Diagram. Connect the excitations of a controller to the port `excitation`.

    task: as the controller knows it. perturbed: as it is, with the perturbations of load, strength and start. varies:
    whether load, strength, delay and motor noise differ from run to run. sensed: what the controller gets of its body,
    by the names of signals; at least arm_state and activation. delays: of what is sensed. noise: of the excitations, if
    the runs vary. told: what senses and rewards read of the episode, by the names of signals. to_begin: what is
    prepared for each run.
    """

    task: TrackingTask
    perturbed: TrackingTask
    varies: bool
    arm: MuscleArm
    reference: ReferenceSource
    excitation: InputPort
    sensed: dict[str, OutputPort]
    proprioception: Proprioception
    reward: TrackingReward
    delays: tuple[DelayLine, ...]
    noise: ExcitationNoise | None
    told: dict[str, ConstantVectorSource]
    to_begin: tuple[BeginsRun, ...]

    def Reset(
        self, root_context: Context, rng: np.random.Generator | None = None, task: TrackingTask | None = None
    ) -> Episode:
        """Draws an episode, sets the arm and the time to its start, and returns it. The time is that on the reference.

        The posture is clamped to the ranges of the joints. rng: what all that is random comes from, in the start, in
        the randomization and in perturbations. Without it nothing is random. task: another task, whose reference,
        load, start and randomization the run has; only if the systems vary.
        """
        episode = (task or self.perturbed).episode(rng)
        if task is not None:
            self.reference.SetReference(root_context, task.reference)
        if self.varies:
            self.arm.SetBody(root_context, episode.load_mass, episode.strength)
        if self.noise is not None:
            steps, n = len((task or self.perturbed).reference.t), len(self.task.arm.muscles)
            self.noise.SetFactors(root_context, episode.noise_factors(steps, n))
        for name, source in self.told.items():
            value = source.get_mutable_source_value(source.GetMyMutableContextFromRoot(root_context))
            value.SetFromVector(np.broadcast_to(getattr(episode, name), value.size()))
        plant, start = self.arm.plant, episode.start
        q = np.clip(start.q, plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits())
        root_context.SetTime(start.step * CONTROL_STEP)
        self.arm.SetState(root_context, q, np.broadcast_to(start.v, len(q)), start.activation)
        for line in self.delays:
            line.SetSteps(root_context, episode.delay_steps)
        for system in self.to_begin:
            system.Begin(root_context, rng)
        return episode._replace(start=start._replace(q=q))


def AddTrackingTask(
    builder: DiagramBuilder,
    task: TrackingTask,
    scene_graph: SceneGraph | None = None,
    perturbations: Sequence[Perturbation] = (),
    *,
    varies: bool | None = None,
    reference: ReferenceSource | None = None,
) -> TaskSystems:
    """Adds arm, reference, senses and reward to a builder and connects them.

    perturbations: what disturbs the arm and its senses. The observation and the reward stay those of the task. varies:
    whether each run can have another load, strength, delay and motor noise; by default it can if the task has a
    randomization. reference: a system of the builder that puts out the reference; by default the one of the task.

    The task's start is also the start of Drake's own contexts: the default context has the posture without noise, and
    SetRandomContext draws a posture with noise (`Start.random_posture`).
    """
    moved = task
    for perturbation in perturbations:
        moved = perturbation.perturb_task(moved)
    varies = bool(task.randomization) if varies is None else varies
    arm = AddMuscleArm(
        builder,
        moved.arm,
        load_mass=moved.load_mass,
        variable_load=varies,
        scene_graph=scene_graph,
        obstacle=task.obstacle,
    )
    arm.plant.SetDefaultPositions(moved.start(task.reference, None).q)
    for name, angle in zip(task.arm.coordinates, moved.start.random_posture(task.reference), strict=True):
        arm.plant.GetMutableJointByName(name).set_random_angle_distribution(angle)

    n = len(task.arm.muscles)
    if reference is None:
        reference = builder.AddNamedSystem("reference", ReferenceSource(task.reference, task.lookahead))
    body = {"arm_state": arm.plant.get_state_output_port()}
    body |= {name: arm.muscles.GetOutputPort(name) for name in OF_BODY if arm.muscles.HasOutputPort(name)}
    signals = body | {name: reference.GetOutputPort(name) for name in ("reference", "preview_q", "preview_v")}
    signals["metabolic_power"] = arm.muscles.GetOutputPort("metabolic_power")
    signals["arm_acceleration"] = arm.plant.get_generalized_acceleration_output_port()
    proprioception = builder.AddNamedSystem("proprioception", Proprioception(task))
    read = {*proprioception.observation.reads, *task.reward.reads}
    if read & {"tracking_error", "accumulated_error"}:
        body["tracking_error"] = _difference(builder, signals["reference"], signals["arm_state"])
    if "accumulated_error" in read:
        body["accumulated_error"] = _accumulated(builder, body["tracking_error"])
    signals |= {name: body[name] for name in ("tracking_error", "accumulated_error") if name in body}
    told = {}
    for name in sorted(read & {"load_mass", "strength"}):
        value = np.broadcast_to(getattr(moved.episode(None), name), signal_size(name, task.arm, task.lookahead))
        told[name] = builder.AddNamedSystem(f"{name}_of_episode", ConstantVectorSource(value))
        signals[name] = told[name].get_output_port()
    reward = builder.AddNamedSystem("tracking_reward", TrackingReward(task))
    excitation, noise = arm.muscles.GetInputPort("excitation"), None
    if varies or perturbations or read & {"excitation", "recent_excitation"}:
        shared = builder.AddNamedSystem("excitation", PassThrough(n))
        perturbed = signals["excitation"] = shared.get_output_port()
        if "recent_excitation" in read:
            recent = builder.AddNamedSystem("recent_excitation", DelayLine(CONTROL_STEP, RECENT, n, empty=True))
            builder.Connect(perturbed, recent.get_input_port())
            signals["recent_excitation"] = recent.GetOutputPort("past_u")
        if varies:
            noise = builder.AddNamedSystem("excitation_noise", ExcitationNoise(n))
            builder.Connect(perturbed, noise.get_input_port())
            perturbed = noise.get_output_port()
        for perturbation in perturbations:
            perturbed = perturbation.perturb_excitation(builder, perturbed)
        builder.Connect(perturbed, excitation)
        excitation = shared.get_input_port()
    sensed = {name: body[name] for name in body if name in (*proprioception.observation.reads, *_ALWAYS_SENSED)}
    delays = {}
    longest = LONGEST_STEPS if varies else task.episode(None).delay_steps
    for name in sensed if longest else ():
        delays[name] = builder.AddNamedSystem(f"delayed_{name}", DelayLine(CONTROL_STEP, longest, sensed[name].size()))
        builder.Connect(sensed[name], delays[name].get_input_port())
        sensed[name] = delays[name].GetOutputPort("delayed_u")
    for perturbation in perturbations:
        sensed = {name: perturbation.perturb_sense(builder, name, signal) for name, signal in sensed.items()}
    if perturbations:
        perturb_plant(builder, arm, perturbations)
    for system, available in ((proprioception, signals | sensed), (reward, signals)):
        for i in range(system.num_input_ports()):
            port = system.get_input_port(i)
            builder.Connect(available[port.get_name()], port)
    to_begin = tuple(system for system in builder.GetSystems() if isinstance(system, BeginsRun))
    lines = tuple(delays.values())
    return TaskSystems(
        task, moved, varies, arm, reference, excitation, sensed, proprioception, reward, lines, noise, told, to_begin
    )


def _difference(builder: DiagramBuilder, first: OutputPort, second: OutputPort) -> OutputPort:
    """The first vector minus the second one."""
    negative = builder.AddSystem(Gain(-1.0, second.size()))
    difference = builder.AddNamedSystem("tracking_error", Adder(2, first.size()))
    builder.Connect(second, negative.get_input_port())
    builder.Connect(first, difference.get_input_port(0))
    builder.Connect(negative.get_output_port(), difference.get_input_port(1))
    return difference.get_output_port()


def _accumulated(builder: DiagramBuilder, error: OutputPort) -> OutputPort:
    """The integral of the first half of an error, that of q, which is forgotten little by little."""
    n_q = error.size() // 2
    identity, of_q = np.eye(n_q), np.eye(n_q, 2 * n_q)
    memory = builder.AddNamedSystem(
        "accumulated_error",
        LinearSystem(REMEMBERED * identity, CONTROL_STEP * of_q, identity, 0.0 * of_q, CONTROL_STEP),
    )
    builder.Connect(error, memory.get_input_port())
    return memory.get_output_port()


def MakeTrackingTask(
    task: TrackingTask, *, varies: bool | None = None, meshcat: Meshcat | None = None
) -> tuple[Diagram, TaskSystems]:
    """A Diagram with the ports that `DiagramEnv` and pydrake.gym expect, and its systems.

    varies: see `AddTrackingTask`. Input: actions, which are the excitations (n,). Outputs: observations
    (`Proprioception`) and reward (1,). Further outputs, for information only: arm_state (2 n_q,), tracking_error (n_q,)
    and activation (n,). meshcat: where the arm is drawn.
    """
    builder = DiagramBuilder()
    systems = AddTrackingTask(builder, task, varies=varies)
    if meshcat:
        AddMuscleVisualizer(builder, systems.arm, meshcat)
    builder.ExportInput(systems.excitation, "actions")
    builder.ExportOutput(systems.proprioception.get_output_port(), "observations")
    builder.ExportOutput(systems.reward.GetOutputPort("reward"), "reward")
    builder.ExportOutput(systems.arm.plant.get_state_output_port(), "arm_state")
    builder.ExportOutput(systems.reward.GetOutputPort("tracking_error"), "tracking_error")
    builder.ExportOutput(systems.arm.muscles.GetOutputPort("activation"), "activation")
    diagram = builder.Build()
    diagram.set_name("tracking_task")
    return diagram, systems
