"""The task that policies learn: follow a reference with the muscles."""

from dataclasses import dataclass

import numpy as np
from pydrake.geometry import SceneGraph
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import MatrixGain, TrajectorySource

from drakearm.diagrams.muscle_arm import AddMuscleArm, MuscleArm
from drakearm.model import Arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import Reference
from drakearm.systems.proprioception import LOOKAHEAD, Proprioception
from drakearm.systems.tracking_reward import RewardWeights, TrackingReward


@dataclass(frozen=True)
class TrackingTask:
    """What is to be followed, with what, and how it is sensed and rewarded."""

    arm: Arm
    reference: Reference
    reward: RewardWeights
    observation: str = "full"  # one of `OBSERVATIONS`
    load_mass: float = 0.0  # kg, in the hand
    start_noise: float = 0.0  # rad, standard deviation of the joint angles at the start
    obstacle: Obstacle | None = None  # drawn; the reference goes around it


@dataclass(frozen=True)
class TaskSystems:
    """The systems of a task in a Diagram. What decides the excitations is still to be connected."""

    task: TrackingTask
    arm: MuscleArm
    reference: TrajectorySource
    proprioception: Proprioception
    reward: TrackingReward

    def StartPosture(self, rng: np.random.Generator | None = None) -> np.ndarray:
        """Joint angles (n_q,) at the start of the reference, plus the start noise if a generator is given."""
        plant, q = self.arm.plant, self.task.reference.q[0]
        if rng is not None:
            q = q + self.task.start_noise * rng.standard_normal(len(q))
        return np.clip(q, plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits())

    def Reset(self, root_context: Context, rng: np.random.Generator | None = None) -> None:
        """Puts the arm at rest in a start posture."""
        self.arm.SetState(root_context, self.StartPosture(rng))


def AddTrackingTask(builder: DiagramBuilder, task: TrackingTask, scene_graph: SceneGraph | None = None) -> TaskSystems:
    """Adds arm, reference, senses and reward to a builder and connects them."""
    arm = AddMuscleArm(builder, task.arm, load_mass=task.load_mass, scene_graph=scene_graph, obstacle=task.obstacle)
    reference = builder.AddNamedSystem("reference", TrajectorySource(task.reference.preview_trajectory(LOOKAHEAD), 1))
    proprioception = builder.AddNamedSystem("proprioception", Proprioception(task.arm, task.observation))
    sources = {
        "fiber_length": arm.muscles.GetOutputPort("fiber_length"),
        "fiber_velocity": arm.muscles.GetOutputPort("fiber_velocity"),
        "activation": arm.muscles.GetOutputPort("activation"),
        "arm_state": arm.plant.get_state_output_port(),
        "reference": reference.get_output_port(),
    }
    for i in range(proprioception.num_input_ports()):
        port = proprioception.get_input_port(i)
        builder.Connect(sources[port.get_name()], port)

    reward = builder.AddNamedSystem("tracking_reward", TrackingReward(task.reward))
    n_q, half = len(task.arm.coordinates), len(task.arm.coordinates) * len(LOOKAHEAD)
    now = np.r_[0:n_q, half : half + n_q]  # of the preview, what is wanted at this moment
    present = builder.AddNamedSystem("present_reference", MatrixGain(np.eye(2 * half)[now]))
    builder.Connect(reference.get_output_port(), present.get_input_port())
    builder.Connect(present.get_output_port(), reward.GetInputPort("reference"))
    builder.Connect(sources["arm_state"], reward.GetInputPort("arm_state"))
    builder.Connect(
        arm.plant.get_generalized_acceleration_output_port(),
        reward.GetInputPort("arm_acceleration"),
    )
    return TaskSystems(task, arm, reference, proprioception, reward)


def MakeTrackingTask(task: TrackingTask) -> tuple[Diagram, TaskSystems]:
    """A Diagram with the ports that `DiagramEnv` and pydrake.gym expect, and its systems.

    Input: actions, the excitations (n,). Outputs: observations (`Proprioception`), reward (1,), and for information
    arm_state (2 n_q,), tracking_error (n_q,) and activation (n,).
    """
    builder = DiagramBuilder()
    systems = AddTrackingTask(builder, task)
    muscles = systems.arm.muscles
    builder.ExportInput(muscles.GetInputPort("excitation"), "actions")
    builder.ExportOutput(systems.proprioception.get_output_port(), "observations")
    builder.ExportOutput(systems.reward.GetOutputPort("reward"), "reward")
    builder.ExportOutput(systems.arm.plant.get_state_output_port(), "arm_state")
    builder.ExportOutput(systems.reward.GetOutputPort("tracking_error"), "tracking_error")
    builder.ExportOutput(muscles.GetOutputPort("activation"), "activation")
    diagram = builder.Build()
    diagram.set_name("tracking_task")
    return diagram, systems
