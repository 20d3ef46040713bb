"""ArmVectorEnv: tracking tasks for many arms at once, stepped by one compiled call."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from pydrake.multibody.plant import MultibodyPlant

from drakearm.diagrams.muscle_arm import TIME_STEP
from drakearm.errors import ActionError, TrainingError
from drakearm.learning.checkpoint import generator_state, restored_generator
from drakearm.learning.compiled_arm import CompiledArms
from drakearm.model import MakeTorqueArm
from drakearm.model.dynamics_table import read_dynamics
from drakearm.model.musculature import resting_states, tendon_forces_of_arms
from drakearm.model.reference import CONTROL_STEP, sample_ranges
from drakearm.task import Reward, TrackingTask


class ArmVectorEnv(VectorEnv):
    """Many environments in one object. Each computes the same as a `DiagramEnv` of its task, up to rounding errors.

    tasks: one task, or several that are assigned round-robin: arm i has task i % len(tasks), with the reference, load,
    start and reward of this task. Muscles, coordinates, joint ranges, senses and lookahead must be the same in all
    tasks; if they are not, a TrainingError names what differs.

    Spaces, rewards and info are those of `DiagramEnv`. An environment is reset in the same step in which its episode
    ends (AutoresetMode.SAME_STEP). This step returns the first observation of the next episode. The last observation of
    the old episode is in `info["final_obs"]`, and the rest of info belongs to the last transition. Environment i is
    seeded with `seed + i`.
    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": []}  # noqa: RUF012

    def __init__(self, tasks: TrackingTask | Sequence[TrackingTask], num_envs: int):
        tasks = [tasks] if isinstance(tasks, TrackingTask) else list(tasks)
        if not 1 <= len(tasks) <= num_envs:
            raise TrainingError(
                f"There are {len(tasks)} tasks for {num_envs} arms: expected at least one arm for each task."
            )
        plants = [MakeTorqueArm(task.arm, task.load_mass) for task in tasks]
        _check_alike(tasks, plants)
        arm = tasks[0].arm
        self._arm, self._observation = arm, tasks[0].observation
        self._lower, self._upper = plants[0].GetPositionLowerLimits(), plants[0].GetPositionUpperLimits()

        self.num_envs = num_envs
        task_of_arm = np.arange(num_envs) % len(tasks)
        self._task = [tasks[k] for k in task_of_arm]
        skeletons = [read_dynamics(plant) for plant in plants]
        self._arms = CompiledArms(arm, [skeletons[k] for k in task_of_arm], self._lower, self._upper)
        self._rewards = _arms_by_reward([task.reward for task in tasks], task_of_arm)
        # The samples of all references, one reference after the other. Arm i follows rows _first[i] to _last[i].
        self._reference = np.concatenate([task.reference.preview() for task in tasks])
        previews = [task.reference.preview(task.lookahead) for task in tasks]
        halves = np.hsplit(np.concatenate(previews), 2)
        self._preview_q, self._preview_v = (np.ascontiguousarray(half) for half in halves)
        self._first, self._last = sample_ranges(np.array([len(preview) for preview in previews]), task_of_arm)
        self._row = self._first.copy()

        n, n_q = len(arm.muscles), len(arm.coordinates)
        self._n, self._n_q = n, n_q
        self._excitation, self._acceleration = np.zeros((num_envs, n)), np.zeros((num_envs, n_q))
        self._signals: dict[str, Callable[[], np.ndarray]] = {
            "arm_state": lambda: self._arm_state,
            "arm_acceleration": lambda: self._acceleration,
            "reference": lambda: self._reference.take(self._row, axis=0),
            "preview_q": lambda: self._preview_q.take(self._row, axis=0),
            "preview_v": lambda: self._preview_v.take(self._row, axis=0),
            "excitation": lambda: self._excitation,
            "activation": lambda: self._muscle_state[:, :n],
            "fiber_length": lambda: self._muscle_state[:, n : 2 * n],
            "fiber_velocity": lambda: self._muscle_state[:, 3 * n :],
            "tendon_force": self._tendon_force,
        }
        self._generators = [np.random.default_rng() for _ in range(num_envs)]
        self.single_action_space = Box(0.0, 1.0, (n,), np.float32)
        self.single_observation_space = Box(-np.inf, np.inf, (self._observation.size,), np.float32)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Starts an episode in every environment; see gymnasium.vector.VectorEnv.reset. There are no options."""
        if seed is not None:
            seeds = range(seed, seed + self.num_envs) if isinstance(seed, int) else seed
            self._generators = [
                generator if env_seed is None else np.random.default_rng(env_seed)
                for generator, env_seed in zip(self._generators, seeds, strict=True)
            ]
        self._restart(np.ones(self.num_envs, dtype=bool))
        return self._observe(), self._info()

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Advances every environment by a control step. Raises ActionError unless actions are (N, n) finite numbers."""
        values = np.array(actions, dtype=np.float64, order="C")  # a copy, which is kept
        if values.shape != self.action_space.shape or not np.isfinite(values).all():
            raise ActionError(
                f"The actions have the shape {values.shape} and {np.sum(~np.isfinite(values))} values that are not "
                f"finite: expected {self.num_envs} times {self._n} finite excitations."
            )
        self._acceleration = self._arms.step(values, round(CONTROL_STEP / TIME_STEP), TIME_STEP)
        self._arm_state, self._muscle_state = self._arms.arm_state, self._arms.muscle_state
        self._excitation = values
        self._row += 1
        reward = self._reward()
        truncated = self._row == self._last
        info = self._info()
        observation = self._observe()
        if truncated.any():
            info["final_obs"], info["_final_obs"] = observation, truncated
            self._restart(truncated)
            observation = self._observe()
        return observation, reward, np.zeros_like(truncated), truncated, info

    @property
    def state(self) -> dict[str, np.ndarray]:
        """All that the next steps depend on, by name. To set it continues all episodes where they were."""
        return {
            "arm_state": self._arm_state,
            "muscle_state": self._muscle_state,
            "acceleration": self._acceleration,
            "excitation": self._excitation,
            "row": self._row,
            "generators": np.array([generator_state(generator) for generator in self._generators]),
        }

    @state.setter
    def state(self, arrays: dict[str, np.ndarray]) -> None:
        self._arms.set_state(np.ones(self.num_envs, bool), arrays["arm_state"], arrays["muscle_state"])
        self._arm_state, self._muscle_state = self._arms.arm_state, self._arms.muscle_state
        self._acceleration, self._excitation = arrays["acceleration"].copy(), arrays["excitation"].copy()
        self._row = arrays["row"].copy()
        self._generators = [restored_generator(state) for state in arrays["generators"]]

    @property
    def reference_step(self) -> np.ndarray:
        """The control step that each arm has reached on its reference, (N,), from 0."""
        return self._row - self._first

    def _restart(self, which: np.ndarray) -> None:
        arms = np.flatnonzero(which)
        starts = [self._task[k].start(self._task[k].reference, self._generators[k]) for k in arms]
        arm_state, activation = np.empty((len(starts), 2 * self._n_q)), np.empty((len(starts), self._n))
        for k, start in enumerate(starts):
            arm_state[k, : self._n_q], arm_state[k, self._n_q :], activation[k] = start.q, start.v, start.activation
        q = arm_state[:, : self._n_q].clip(self._lower, self._upper)
        arm_state[:, : self._n_q] = q
        self._row[which] = self._first[which] + np.array([start.step for start in starts])
        self._excitation[which] = 0.0
        self._arms.set_state(which, arm_state, resting_states(self._arm, q, activation))
        self._arm_state, self._muscle_state = self._arms.arm_state, self._arms.muscle_state

    def _observe(self) -> np.ndarray:
        signals = {name: self._signals[name]() for name in self._observation.reads}
        return self._observation(signals).astype(np.float32)

    def _reward(self) -> np.ndarray:
        if len(self._rewards) == 1:
            reward, _ = self._rewards[0]
            return reward(*(self._signals[name]() for name in reward.reads))
        total = np.empty(self.num_envs)
        for reward, arms in self._rewards:
            total[arms] = reward(*(self._signals[name]()[arms] for name in reward.reads))
        return total

    def _tendon_force(self) -> np.ndarray:
        fibers = np.ascontiguousarray(self._muscle_state[:, : 2 * self._n])
        return tendon_forces_of_arms(fibers, self._arm_state, self._arm.muscle_table, self._arm.path_table)

    def _info(self) -> dict[str, Any]:
        info = {
            "arm_state": self._arm_state,
            "tracking_error": (self._arm_state - self._reference.take(self._row, axis=0))[:, : self._n_q],
            "activation": self._muscle_state[:, : self._n],
        }
        everywhere = np.ones(self.num_envs, dtype=bool)
        return info | {f"_{name}": everywhere for name in info}


def _arms_by_reward(rewards: list[Reward], task_of_arm: np.ndarray) -> list[tuple[Reward, np.ndarray]]:
    """Each distinct reward of the tasks, with the indices of the arms that have it."""
    distinct = [reward for k, reward in enumerate(rewards) if reward not in rewards[:k]]
    reward_of_task = np.array([distinct.index(reward) for reward in rewards])
    return [(reward, np.flatnonzero(reward_of_task[task_of_arm] == k)) for k, reward in enumerate(distinct)]


def _check_alike(tasks: list[TrackingTask], plants: list[MultibodyPlant]) -> None:
    """Raises TrainingError, which names what differs, if the tasks cannot share one compiled function."""
    alike = [
        {
            "muscles": task.arm.muscles,
            "coordinates": task.arm.coordinates,
            "senses": task.senses,
            "lookahead": task.lookahead,
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
