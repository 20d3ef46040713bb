"""The excitations that static optimization chooses for many arms. Imitation learns from them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.model.feedback import Feedback
from drakearm.model.muscle_control import excitations_for
from drakearm.model.reference import CONTROL_STEP, sample_ranges

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

    def __init__(self, envs: ArmVectorEnv, aims: Sequence[Aim] | None = None) -> None:
        """aims: one per task of the environments, by default the references."""
        self._envs = envs
        tasks = envs.tasks
        self.aims = aims or [Aim(task.reference.q, task.reference.v, task.reference.a) for task in tasks]
        self._priority = np.array([task.reward.priority(task.arm) for task in tasks])
        self._muscles, self._paths = tasks[0].arm.muscle_table, tasks[0].arm.path_table
        self._activation = np.full((envs.num_envs, len(self._muscles)), 0.1)  # the latest solution, the next guess

    @property
    def aims(self) -> Sequence[Aim]:
        """What the expert aims at, one per task."""
        return self._aims

    @aims.setter
    def aims(self, aims: Sequence[Aim]) -> None:
        self._aims = aims
        self._samples = np.concatenate([np.hstack(aim) for aim in aims])  # task i has rows _first[i] to _last[i]
        self._first, self._last = sample_ranges(np.array([len(aim.q) for aim in aims]))

    def act(self, arm_state: np.ndarray, activation: np.ndarray) -> np.ndarray:
        """The excitations (N, n) for the next control step.

        arm_state: (N, 2 n_q), q in rad and v in rad/s. activation: (N, n). The environments tell the expert which
        movement each arm makes, how far it has come, and which load it carries, but not how strong its muscles are.
        """
        task = self._envs.task_of_arm
        rows = np.minimum(self._first[task] + self._envs.reference_step + 1, self._last[task])
        q, v = np.hsplit(arm_state, 2)
        q = q + CONTROL_STEP * v
        a = FEEDBACK.acceleration(q, v, self._samples[rows])
        excitation: np.ndarray = excitations_for(
            q,
            np.ascontiguousarray(v),
            a,
            np.ascontiguousarray(activation),
            self._activation,
            self._priority[task],
            CONTROL_STEP,
            self._muscles,
            self._paths,
            self._envs.skeletons,
        )
        return excitation
