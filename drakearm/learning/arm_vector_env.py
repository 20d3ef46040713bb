"""ArmVectorEnv: the tracking task for many arms at once, stepped by one compiled call."""

from typing import Any

import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from drakearm.diagrams import MakeTrackingTask, TrackingTask
from drakearm.diagrams.muscle_arm import TIME_STEP
from drakearm.errors import ActionError
from drakearm.learning.compiled_arm import rewards, step_arms
from drakearm.model.dynamics import read_dynamics
from drakearm.model.musculature import resting_states
from drakearm.model.reference import CONTROL_STEP
from drakearm.systems.hill_muscles import RESTING_ACTIVATION
from drakearm.systems.proprioception import LOOKAHEAD, observation_scales


class ArmVectorEnv(VectorEnv):
    """Many copies of the environment that `DiagramEnv` makes of a `TrackingTask`, to rounding errors the same.

    Spaces, rewards and info are those of `DiagramEnv`; see there. Environments that end are reset in the same step
    (AutoresetMode.SAME_STEP): the observation is then the first of the next episode, the last one of the episode that
    ended is in `info["final_obs"]`, and the other info is that of the transition. Environment i is seeded with `seed +
    i`.
    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": []}  # noqa: RUF012

    def __init__(self, task: TrackingTask, num_envs: int):
        _, systems = MakeTrackingTask(task)
        plant, stops = systems.arm.plant, systems.arm.stops
        self.num_envs = num_envs
        self._task = task
        self._tables = (task.arm.muscle_table, task.arm.path_table, read_dynamics(plant))
        self._stops = (stops.lower, stops.upper, stops.stiffness, stops.damping)
        self._weights = task.reward.arrays()
        self._preview = task.reference.preview(LOOKAHEAD)
        scales = observation_scales(task.arm, task.observation)
        self._senses, self._scale = tuple(scales), np.concatenate(list(scales.values()))

        n, n_q = len(task.arm.muscles), len(task.arm.coordinates)
        self._n, self._n_q = n, n_q
        self._arm_state = np.zeros((num_envs, 2 * n_q))
        self._muscle_state = np.zeros((num_envs, 4 * n))
        self._torque = np.zeros((num_envs, n_q))
        self._steps = np.zeros(num_envs, dtype=int)
        self._generators = [np.random.default_rng() for _ in range(num_envs)]
        self.single_action_space = Box(0.0, 1.0, (n,), np.float32)
        self.single_observation_space = Box(-np.inf, np.inf, (len(self._scale),), np.float32)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

    def reset(
        self, *, seed: int | list[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Starts an episode in every environment; see gymnasium.vector.VectorEnv.reset. There are no options."""
        if seed is not None:
            seeds = range(seed, seed + self.num_envs) if isinstance(seed, int) else seed
            self._generators = [np.random.default_rng(s) for s in seeds]
        everywhere = np.ones(self.num_envs, dtype=bool)
        self._restart(everywhere)
        return self._observe(), self._info(everywhere)

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """One control step everywhere. Raises ActionError unless the actions are (N, n) finite numbers."""
        values = np.ascontiguousarray(actions, dtype=np.float64)
        if values.shape != self.action_space.shape or not np.isfinite(values).all():
            raise ActionError(
                f"The actions are an array {values.shape}, finite: {bool(np.isfinite(values).all())}: "
                f"expected {self.num_envs} times {self._n} finite excitations."
            )
        muscles, paths, dynamics = self._tables
        acceleration = step_arms(
            self._arm_state,
            self._muscle_state,
            self._torque,
            values,
            round(CONTROL_STEP / TIME_STEP),
            TIME_STEP,
            muscles,
            paths,
            dynamics,
            self._stops,
        )
        self._steps += 1
        reference_q, reference_v = self._wanted()
        reward = rewards(self._arm_state, acceleration, reference_q, reference_v, self._weights)
        truncated = self._steps >= len(self._preview) - 1
        info = self._info(np.ones(self.num_envs, dtype=bool))
        observation = self._observe()
        if truncated.any():
            info["final_obs"], info["_final_obs"] = observation, truncated
            self._restart(truncated)
            observation = self._observe()
        return observation, reward, np.zeros_like(truncated), truncated, info

    def _restart(self, which: np.ndarray) -> None:
        normals = np.array([self._generators[k].standard_normal(self._n_q) for k in np.flatnonzero(which)])
        start, noise = self._task.reference.q[0], self._task.start_noise  # as in TaskSystems.StartPosture
        q = np.clip(start + noise * normals, self._stops[0], self._stops[1])
        self._arm_state[which] = np.hstack([q, np.zeros_like(q)])
        self._muscle_state[which], self._torque[which] = resting_states(self._task.arm, q, RESTING_ACTIVATION)
        self._steps[which] = 0

    def _wanted(self) -> tuple[np.ndarray, np.ndarray]:
        """The q and v, each (N, n_q), that the reference wants now."""
        wanted = self._preview[self._steps]
        half = wanted.shape[1] // 2
        return (
            np.ascontiguousarray(wanted[:, : self._n_q]),
            np.ascontiguousarray(wanted[:, half : half + self._n_q]),
        )

    def _observe(self) -> np.ndarray:
        activation, fiber_length, _, fiber_velocity = np.split(self._muscle_state, 4, axis=1)
        senses = {
            "fiber_length": fiber_length,
            "fiber_velocity": fiber_velocity,
            "activation": activation,
            "arm_state": self._arm_state,
            "reference": self._preview[self._steps],
        }
        observation, first = np.empty((self.num_envs, len(self._scale)), np.float32), 0
        for name in self._senses:
            last = first + senses[name].shape[1]
            np.multiply(senses[name], self._scale[first:last], out=observation[:, first:last], casting="same_kind")
            first = last
        return observation

    def _info(self, told: np.ndarray) -> dict[str, Any]:
        info = {
            "arm_state": self._arm_state.copy(),
            "tracking_error": self._arm_state[:, : self._n_q] - self._wanted()[0],
            "activation": self._muscle_state[:, : self._n].copy(),
        }
        return info | {f"_{name}": told for name in info}
