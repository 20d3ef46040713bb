"""ArmVectorEnv: tracking tasks for many arms at once, stepped by one compiled call."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from pydrake.multibody.plant import MultibodyPlant

from drakearm.diagrams import TrackingTask
from drakearm.diagrams.muscle_arm import TIME_STEP
from drakearm.errors import ActionError, TrainingError
from drakearm.learning.compiled_arm import CompiledArms
from drakearm.model import MakeTorqueArm
from drakearm.model.dynamics_table import read_dynamics
from drakearm.model.musculature import resting_states
from drakearm.model.reference import CONTROL_STEP, sample_ranges
from drakearm.model.tracking import tracking_reward
from drakearm.systems.hill_muscles import RESTING_ACTIVATION
from drakearm.systems.proprioception import LOOKAHEAD, observation_scales


class ArmVectorEnv(VectorEnv):
    """Many environments, each the one that `DiagramEnv` makes of a `TrackingTask`, to rounding errors the same.

    tasks: one, or several to mix: arm i does task i % len(tasks), with a reference, load, start and reward of its own.
    Muscles, coordinates, joint stops and observation are the same in all tasks, or TrainingError names what differs.

    Spaces, rewards and info are those of `DiagramEnv`; see there. Environments that end are reset in the same step
    (AutoresetMode.SAME_STEP): the observation is then the first of the next episode, the last one of the episode that
    ended is in `info["final_obs"]`, and the other info is that of the transition. Environment i is seeded with `seed +
    i`.
    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": []}  # noqa: RUF012

    def __init__(self, tasks: TrackingTask | Sequence[TrackingTask], num_envs: int):
        tasks = [tasks] if isinstance(tasks, TrackingTask) else list(tasks)
        if not 1 <= len(tasks) <= num_envs:
            raise TrainingError(f"There are {len(tasks)} tasks for {num_envs} arms: expected an arm for every task.")
        plants = [MakeTorqueArm(task.arm, task.load_mass) for task in tasks]
        _check_alike(tasks, plants)
        arm = tasks[0].arm
        scales = observation_scales(arm, tasks[0].observation)
        self._senses, self._scale = tuple(scales), np.concatenate(list(scales.values()))
        self._arm = arm
        self._lower, self._upper = plants[0].GetPositionLowerLimits(), plants[0].GetPositionUpperLimits()

        self.num_envs = num_envs
        does = np.arange(num_envs) % len(tasks)  # the task of every arm
        skeletons = [read_dynamics(plant) for plant in plants]
        self._arms = CompiledArms(arm, [skeletons[task] for task in does], self._lower, self._upper)
        self._weights = np.array([task.reward.array() for task in tasks])[does]
        self._start = np.array([task.reference.q[0] for task in tasks])[does]
        self._noise = np.array([task.start_noise for task in tasks])[does]
        previews = [task.reference.preview(LOOKAHEAD) for task in tasks]
        self._preview = np.concatenate(previews)  # of all tasks; every arm goes from its first row to its last
        self._first, self._last = sample_ranges(np.array([len(preview) for preview in previews]), does)
        self._row = self._first.copy()
        self._wanted = np.concatenate([task.reference.preview() for task in tasks])  # what is wanted at this moment

        n, n_q = len(arm.muscles), len(arm.coordinates)
        self._n, self._n_q = n, n_q
        self._generators = [np.random.default_rng() for _ in range(num_envs)]
        self.single_action_space = Box(0.0, 1.0, (n,), np.float32)
        self.single_observation_space = Box(-np.inf, np.inf, (len(self._scale),), np.float32)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Starts an episode in every environment; see gymnasium.vector.VectorEnv.reset. There are no options."""
        if seed is not None:
            seeds = range(seed, seed + self.num_envs) if isinstance(seed, int) else seed
            self._generators = [
                generator if one is None else np.random.default_rng(one)
                for generator, one in zip(self._generators, seeds, strict=True)
            ]
        self._restart(np.ones(self.num_envs, dtype=bool))
        return self._observe(), self._info()

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """One control step everywhere. Raises ActionError unless the actions are (N, n) finite numbers."""
        values = np.ascontiguousarray(actions, dtype=np.float64)
        if values.shape != self.action_space.shape or not np.isfinite(values).all():
            raise ActionError(
                f"The actions are an array {values.shape}, finite: {bool(np.isfinite(values).all())}: "
                f"expected {self.num_envs} times {self._n} finite excitations."
            )
        acceleration = self._arms.step(values, round(CONTROL_STEP / TIME_STEP), TIME_STEP)
        self._arm_state, self._muscle_state = self._arms.arm_state, self._arms.muscle_state
        self._row += 1
        reward = tracking_reward(self._arm_state, acceleration, self._wanted[self._row], self._weights)
        truncated = self._row == self._last
        info = self._info()
        observation = self._observe()
        if truncated.any():
            info["final_obs"], info["_final_obs"] = observation, truncated
            self._restart(truncated)
            observation = self._observe()
        return observation, reward, np.zeros_like(truncated), truncated, info

    def _restart(self, which: np.ndarray) -> None:
        normals = np.array([self._generators[k].standard_normal(self._n_q) for k in np.flatnonzero(which)])
        q = self._start[which] + self._noise[which, None] * normals  # as in TaskSystems.StartPosture
        q = np.clip(q, self._lower, self._upper)
        arm_state = np.hstack([q, np.zeros_like(q)])
        self._row[which] = self._first[which]
        self._set_state(which, arm_state, resting_states(self._arm, q, RESTING_ACTIVATION))

    def _set_state(self, which: np.ndarray, arm_state: np.ndarray, muscle_state: np.ndarray) -> None:
        self._arms.set_state(which, arm_state, muscle_state)
        self._arm_state, self._muscle_state = self._arms.arm_state, self._arms.muscle_state

    def _observe(self) -> np.ndarray:
        n = self._n
        senses = {
            "fiber_length": self._muscle_state[:, n : 2 * n],
            "fiber_velocity": self._muscle_state[:, 3 * n :],
            "activation": self._muscle_state[:, :n],
            "arm_state": self._arm_state,
            "reference": self._preview[self._row],
        }
        sensed = np.concatenate([senses[name] for name in self._senses], axis=1)
        return (sensed * self._scale).astype(np.float32)

    def _info(self) -> dict[str, Any]:
        info = {
            "arm_state": self._arm_state,
            "tracking_error": (self._arm_state - self._wanted[self._row])[:, : self._n_q],
            "activation": self._muscle_state[:, : self._n],
        }
        everywhere = np.ones(self.num_envs, dtype=bool)
        return info | {f"_{name}": everywhere for name in info}


def _check_alike(tasks: list[TrackingTask], plants: list[MultibodyPlant]) -> None:
    """Raises TrainingError, naming what differs, unless one compiled arm can do all tasks."""
    alike = [
        {
            "muscles": task.arm.muscles,
            "coordinates": task.arm.coordinates,
            "observation": task.observation,
            "joint ranges": (list(plant.GetPositionLowerLimits()), list(plant.GetPositionUpperLimits())),
        }
        for task, plant in zip(tasks, plants, strict=True)
    ]
    for i, other in enumerate(alike):
        different = [name for name in other if other[name] != alike[0][name]]
        if different:
            raise TrainingError(
                f"Task {i} differs from task 0 in its {' and '.join(different)}: "
                "expected the same in all tasks of one vector environment."
            )
