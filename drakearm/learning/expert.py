"""The excitations that static optimization chooses for many arms. Imitation learns from them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drakearm.model import MakeTorqueArm
from drakearm.model.feedback import Feedback
from drakearm.model.reference import CONTROL_STEP, sample_ranges
from drakearm.model.skeleton import inverse_dynamics
from drakearm.model.static_optimization import acceleration_weighting, excitations_to_reach, static_activations
from drakearm.task import TrackingTask

FEEDBACK = Feedback(stiffness=400.0, damping=40.0)  # a stiffer expert is harder to imitate


class Aim(NamedTuple):
    """The movement that an expert tries to make: angles, speeds and accelerations, (N, n_q), at the control steps."""

    q: np.ndarray  # rad
    v: np.ndarray  # rad/s
    a: np.ndarray  # rad/s^2


class StaticExpert:
    """Computed muscle control (Thelen, Anderson and Delp 2003) for the arms of an `ArmVectorEnv`.

    It differs from `StaticOptimizer` in two points. It uses the method's forecast: it chooses the excitations for the
    joint angles that are expected at the end of the control step. And it can aim at another movement than the
    reference, which `rehearse` finds.
    """

    def __init__(self, tasks: Sequence[TrackingTask], num_envs: int, aims: Sequence[Aim] | None = None) -> None:
        """Arm i has task i % len(tasks), as in `ArmVectorEnv`. aims: one per task, by default the references."""
        self._task_of_arm = np.arange(num_envs) % len(tasks)
        self.aims = aims or [Aim(task.reference.q, task.reference.v, task.reference.a) for task in tasks]
        plants = [MakeTorqueArm(task.arm, task.load_mass) for task in tasks]
        self._skeletons = [(plant, plant.CreateDefaultContext()) for plant in plants]
        self._priorities = [task.reward.priority(task.arm) for task in tasks]
        self._muscles, self._paths = tasks[0].arm.muscle_table, tasks[0].arm.path_table
        self._activation = np.full((num_envs, len(self._muscles)), 0.1)  # the latest solution, the next guess

    @property
    def aims(self) -> Sequence[Aim]:
        """What the expert aims at, one per task."""
        return self._aims

    @aims.setter
    def aims(self, aims: Sequence[Aim]) -> None:
        self._aims = aims
        self._samples = np.concatenate([np.hstack(aim) for aim in aims])  # arm i follows rows _first[i] to _last[i]
        self._first, self._last = sample_ranges(np.array([len(aim.q) for aim in aims]), self._task_of_arm)

    def act(self, arm_state: np.ndarray, activation: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """The excitations (N, n) for the next control step.

        arm_state: (N, 2 n_q), q in rad and v in rad/s. activation: (N, n). steps: (N,), the control step that each arm
        has reached on its reference, from 0.
        """
        q, v = np.hsplit(arm_state, 2)
        q = q + CONTROL_STEP * v
        a = FEEDBACK.acceleration(q, v, self._samples[np.minimum(self._first + steps + 1, self._last)])
        forecast = np.hstack([q, v])
        excitation = np.empty_like(activation)
        for k, task in enumerate(self._task_of_arm):
            plant, context = self._skeletons[task]
            plant.SetPositionsAndVelocities(context, forecast[k])
            tau = inverse_dynamics(plant, context, a[k])
            weighting = acceleration_weighting(plant.CalcMassMatrix(context), self._priorities[task])
            self._activation[k], _ = static_activations(
                q[k], v[k], tau, self._activation[k], weighting, self._muscles, self._paths
            )
            excitation[k] = excitations_to_reach(self._activation[k], activation[k], CONTROL_STEP, self._muscles)
        return excitation
