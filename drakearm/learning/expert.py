"""The excitations that static optimization would choose for many arms: what imitation learns from."""

from collections.abc import Sequence

import numpy as np

from drakearm.diagrams import MakeTorqueArm, TrackingTask
from drakearm.model.reference import CONTROL_STEP
from drakearm.model.skeleton import inverse_dynamics
from drakearm.model.static_optimization import excitations_to_reach, static_activations

# Twice as quick as those of `StaticOptimizer`, which its users can count on without a forecast.
STIFFNESS = 900.0  # 1/s^2
DAMPING = 60.0  # 1/s


class StaticExpert:
    """Computed muscle control (Thelen, Anderson and Delp 2003) for the arms of an `ArmVectorEnv`.

    As `StaticOptimizer`, but with the forecast of the joints that the method has: it decides for where they will be at
    the end of the control step.
    """

    def __init__(self, tasks: Sequence[TrackingTask], num_envs: int) -> None:
        """Arm i does task i % len(tasks), as in `ArmVectorEnv`."""
        self._does = np.arange(num_envs) % len(tasks)
        self._wanted = [np.hstack([task.reference.q, task.reference.v, task.reference.a]) for task in tasks]
        plants = [MakeTorqueArm(task.arm, task.load_mass) for task in tasks]
        self._skeletons = [(plant, plant.CreateDefaultContext()) for plant in plants]
        self._muscles, self._paths = tasks[0].arm.muscle_table, tasks[0].arm.path_table
        self._activation = np.full((num_envs, len(self._muscles)), 0.1)  # the latest ones, as a guess

    def act(self, arm_state: np.ndarray, activation: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """Excitations (N, n) for arms at states (N, 2 n_q), with activations (N, n); steps: (N,), since the start."""
        q, v = np.split(arm_state, 2, axis=1)
        q = q + CONTROL_STEP * v
        excitation = np.empty_like(activation)
        for k, task in enumerate(self._does):
            wanted = self._wanted[task][min(steps[k] + 1, len(self._wanted[task]) - 1)]
            wanted_q, wanted_v, wanted_a = np.split(wanted, 3)
            a = wanted_a + STIFFNESS * (wanted_q - q[k]) + DAMPING * (wanted_v - v[k])
            plant, context = self._skeletons[task]
            plant.SetPositionsAndVelocities(context, np.concatenate([q[k], v[k]]))
            tau = inverse_dynamics(plant, context, a)
            guess = self._activation[k]
            self._activation[k], _ = static_activations(q[k], v[k], tau, guess, self._muscles, self._paths)
            excitation[k] = excitations_to_reach(self._activation[k], activation[k], CONTROL_STEP, self._muscles)
        return excitation
