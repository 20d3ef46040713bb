"""The excitations that static optimization would choose for many arms: what imitation learns from."""

from collections.abc import Sequence

import numpy as np

from drakearm.diagrams import TrackingTask
from drakearm.model import MakeTorqueArm
from drakearm.model.reference import CONTROL_STEP, sample_ranges
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
        wanted = [np.hstack([task.reference.q, task.reference.v, task.reference.a]) for task in tasks]
        self._wanted = np.concatenate(wanted)  # of all tasks; every arm goes from its first row to its last
        self._first, self._last = sample_ranges(np.array([len(samples) for samples in wanted]), self._does)
        plants = [MakeTorqueArm(task.arm, task.load_mass) for task in tasks]
        self._skeletons = [(plant, plant.CreateDefaultContext()) for plant in plants]
        self._muscles, self._paths = tasks[0].arm.muscle_table, tasks[0].arm.path_table
        self._activation = np.full((num_envs, len(self._muscles)), 0.1)  # the latest ones, as a guess

    def act(self, arm_state: np.ndarray, activation: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """Excitations (N, n) for arms at states (N, 2 n_q), with activations (N, n); steps: (N,), since the start."""
        wanted = self._wanted[np.minimum(self._first + steps + 1, self._last)]
        wanted_q, wanted_v, wanted_a = np.hsplit(wanted, 3)
        q, v = np.hsplit(arm_state, 2)
        q = q + CONTROL_STEP * v
        a = wanted_a + STIFFNESS * (wanted_q - q) + DAMPING * (wanted_v - v)
        forecast = np.hstack([q, v])
        excitation = np.empty_like(activation)
        for k, task in enumerate(self._does):
            plant, context = self._skeletons[task]
            plant.SetPositionsAndVelocities(context, forecast[k])
            tau = inverse_dynamics(plant, context, a[k])
            guess = self._activation[k]
            self._activation[k], _ = static_activations(q[k], v[k], tau, guess, self._muscles, self._paths)
            excitation[k] = excitations_to_reach(self._activation[k], activation[k], CONTROL_STEP, self._muscles)
        return excitation
