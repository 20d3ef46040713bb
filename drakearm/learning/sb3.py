"""Stable-Baselines3 on many arms at once: `Sb3VecEnv` gives `ArmVectorEnv` the interface of its algorithms.

Needs `pip install stable-baselines3`. `drakearm.learning` itself has its own PPO and does not need it.
"""

import logging
from typing import Any

import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv

from drakearm.errors import TrainingError
from drakearm.learning.arm_vector_env import ArmVectorEnv


class Sb3VecEnv(VecEnv):
    """An `ArmVectorEnv` as a VecEnv of Stable-Baselines3, for example for PPO, SAC and TD3:

        PPO("MlpPolicy", Sb3VecEnv(ArmVectorEnv(task, 64)), device="cpu").learn(100_000)

    An environment is reset in the step in which its episode ends. Its info then has `terminal_observation`,
    `TimeLimit.truncated`, and under `episode` the sum of rewards `r` and the number of steps `l`, as a Monitor reports
    them. All other infos are empty. All arms are stepped by one compiled call: there is no process and no copy per arm.

    PyTorch should have one thread (`torch.set_num_threads(1)`), because these networks are too small to be worth more.
    If it has more, a warning is logged: training can be ten times slower then.
    """

    def __init__(self, envs: ArmVectorEnv):
        if envs.metadata["autoreset_mode"] is not AutoresetMode.SAME_STEP:
            raise TrainingError("Stable-Baselines3 needs an ArmVectorEnv with the autoreset mode SAME_STEP.")
        if torch.get_num_threads() > 1:
            logging.getLogger("drakearm").warning(
                "PyTorch uses %d threads, which makes training with small networks slow. "
                "Call torch.set_num_threads(1) first.",
                torch.get_num_threads(),
            )
        self.envs = envs
        self.render_mode = None
        self._returns, self._lengths = np.zeros(envs.num_envs), np.zeros(envs.num_envs, dtype=int)
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> np.ndarray:
        """Starts an episode in every environment, with the seeds that `seed` has set."""
        seeds = None if all(seed is None for seed in self._seeds) else self._seeds
        observation, _ = self.envs.reset(seed=seeds)
        self._returns[:], self._lengths[:] = 0.0, 0
        self._reset_seeds()
        self._reset_options()
        return observation

    def step_async(self, actions: np.ndarray) -> None:
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        observation, reward, terminated, truncated, info = self.envs.step(self._actions)
        done = terminated | truncated
        self._returns += reward
        self._lengths += 1
        infos: list[dict[str, Any]] = [{} for _ in done]
        for i in np.flatnonzero(done):
            infos[i] = {
                "terminal_observation": info["final_obs"][i],
                "TimeLimit.truncated": bool(truncated[i] and not terminated[i]),
                "episode": {"r": float(self._returns[i]), "l": int(self._lengths[i])},
            }
            self._returns[i], self._lengths[i] = 0.0, 0
        return observation, reward.astype(np.float32), done, infos

    def close(self) -> None:
        self.envs.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The attribute of the vector environment, once per arm. Raises AttributeError if it has none of this name."""
        owner = self if attr_name == "render_mode" else self.envs
        return [getattr(owner, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        raise TrainingError(f"{attr_name} cannot be set for single arms: expected tasks that differ, in ArmVectorEnv.")

    def env_method(self, method_name: str, *arguments: Any, indices: Any = None, **keywords: Any) -> list[Any]:
        raise TrainingError(f"There is no method {method_name} of single arms: expected one of Sb3VecEnv.envs.")

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        return [False] * len(list(self._get_indices(indices)))
