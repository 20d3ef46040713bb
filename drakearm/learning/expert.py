"""The excitations that static optimization chooses for many arms. Imitation learns from them."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.model.feedback import Feedback
from drakearm.model.muscle_control import excitations_for
from drakearm.model.reference import CONTROL_STEP, sample_ranges

STIFFNESS = 400.0  # 1/s^2, of the feedback: for a single movement a stiffer expert is harder to imitate


class Aim(NamedTuple):
    """The movement that an expert tries to make: angles, speeds and accelerations, (N, n_q), at the control steps."""

    q: np.ndarray  # rad
    v: np.ndarray  # rad/s
    a: np.ndarray  # rad/s^2


class StaticExpert:
    """Computed muscle control (Thelen, Anderson and Delp 2003) for the arms of an `ArmVectorEnv`.

    It differs from `StaticOptimizer` in two points. It uses the method's forecast: it chooses the excitations for the
    joint angles and speeds that are expected at the end of the control step, from the present accelerations. Without
    the forecast, stiff feedback would make the arm tremble. And it can aim at another movement than the reference,
    which `rehearse` finds.
    """

    def __init__(self, envs: ArmVectorEnv, aims: Sequence[Aim] | None = None, stiffness: float = STIFFNESS) -> None:
        """aims: one per task of the environments, by default the references.

        stiffness: 1/s^2, of the feedback of position errors; the damping is critical.
        """
        self._envs = envs
        self._feedback = Feedback(stiffness, 2.0 * math.sqrt(stiffness))
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
        present = self._envs.acceleration
        q, v = q + CONTROL_STEP * v + 0.5 * CONTROL_STEP**2 * present, v + CONTROL_STEP * present
        a = self._feedback.acceleration(q, v, self._samples[rows])
        excitation: np.ndarray = excitations_for(
            q,
            v,
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
