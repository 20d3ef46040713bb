"""The excitations that static optimization would choose for many arms: what imitation learns from."""

from collections.abc import Sequence

import numpy as np

from drakearm.model import MakeTorqueArm
from drakearm.model.feedback import Feedback
from drakearm.model.reference import CONTROL_STEP, sample_ranges
from drakearm.model.skeleton import inverse_dynamics
from drakearm.model.static_optimization import excitations_to_reach, static_activations
from drakearm.task import TrackingTask

# Faster than that of `StaticOptimizer`, because the forecast lets it correct errors sooner without trembling.
FEEDBACK = Feedback(stiffness=900.0, damping=60.0)


class StaticExpert:
    """Computed muscle control (Thelen, Anderson and Delp 2003) for the arms of an `ArmVectorEnv`.

    Like `StaticOptimizer`, but with the method's forecast of the joints: it decides for the state that they will have
    at the end of the control step.
    """

    def __init__(self, tasks: Sequence[TrackingTask], num_envs: int) -> None:
        """Arm i does task i % len(tasks), as in `ArmVectorEnv`."""
        self._task_of_arm = np.arange(num_envs) % len(tasks)
        references = [np.hstack([task.reference.q, task.reference.v, task.reference.a]) for task in tasks]
        self._reference = np.concatenate(references)  # of all tasks; each arm goes from its first row to its last
        self._first, self._last = sample_ranges(np.array([len(r) for r in references]), self._task_of_arm)
        plants = [MakeTorqueArm(task.arm, task.load_mass) for task in tasks]
        self._skeletons = [(plant, plant.CreateDefaultContext()) for plant in plants]
        self._muscles, self._paths = tasks[0].arm.muscle_table, tasks[0].arm.path_table
        self._activation = np.full((num_envs, len(self._muscles)), 0.1)  # the latest ones, as a guess

    def act(self, arm_state: np.ndarray, activation: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """Excitations (N, n) for arms at states (N, 2 n_q), with activations (N, n).

        steps: (N,), of the reference, that each arm has reached.
        """
        q, v = np.hsplit(arm_state, 2)
        q = q + CONTROL_STEP * v
        a = FEEDBACK.acceleration(q, v, self._reference[np.minimum(self._first + steps + 1, self._last)])
        forecast = np.hstack([q, v])
        excitation = np.empty_like(activation)
        for k, task in enumerate(self._task_of_arm):
            plant, context = self._skeletons[task]
            plant.SetPositionsAndVelocities(context, forecast[k])
            tau = inverse_dynamics(plant, context, a[k])
            guess = self._activation[k]
            self._activation[k], _ = static_activations(q[k], v[k], tau, guess, self._muscles, self._paths)
            excitation[k] = excitations_to_reach(self._activation[k], activation[k], CONTROL_STEP, self._muscles)
        return excitation
