"""Stable-Baselines3's PPO on drakearm's vector environment, with drakearm's default settings, collecting and updating.

Run it with `python sb3_ppo.py`, with drakearm and stable-baselines3 installed. Its networks have the sizes of
drakearm's. The activation function of its critic is tanh, that of drakearm's is PReLU.
"""

import statistics
import sys
import time

import numpy as np
import torch

try:
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.vec_env import VecEnv
except ImportError:
    sys.exit("not installed: pip install stable-baselines3")
from rates import is_quick, report

from drakearm.experiments.scenario import load_scenario
from drakearm.learning import ArmVectorEnv, PpoSettings
from drakearm.model import load_arm
from drakearm.planning import plan

BATCHES, QUICK_BATCHES = 8, 3


class Sb3VecEnv(VecEnv):
    """ArmVectorEnv in Stable-Baselines3's form.

    An environment whose episode ends is reset in the same step; the episode's last observation is in the info.
    """

    def __init__(self, envs: ArmVectorEnv):
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)
        self._envs = envs

    def reset(self) -> np.ndarray:
        return self._envs.reset(seed=0)[0]

    def step_async(self, actions: np.ndarray) -> None:
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict]]:
        observation, reward, terminated, truncated, info = self._envs.step(self._actions)
        done = terminated | truncated
        infos: list[dict] = [{} for _ in done]
        for i in np.flatnonzero(done):
            infos[i] = {"terminal_observation": info["final_obs"][i], "TimeLimit.truncated": not terminated[i]}
        return observation, reward.astype(np.float32), done, infos

    def close(self) -> None:
        self._envs.close()

    def get_attr(self, attr_name: str, indices=None) -> list:
        return [getattr(self._envs, attr_name, None)] * self.num_envs

    def set_attr(self, attr_name: str, value, indices=None) -> None:
        raise NotImplementedError

    def env_method(self, method_name: str, *arguments, indices=None, **keywords) -> list:
        raise NotImplementedError

    def env_is_wrapped(self, wrapper_class, indices=None) -> list[bool]:
        return [False] * self.num_envs


class BatchTimes(BaseCallback):
    """Notes the time at which each batch begins, s."""

    def __init__(self):
        super().__init__()
        self.times: list[float] = []

    def _on_rollout_start(self) -> None:
        self.times.append(time.perf_counter())

    def _on_step(self) -> bool:
        return True


def main() -> None:
    batches = QUICK_BATCHES if is_quick(__doc__) else BATCHES
    torch.set_num_threads(1)  # with two it is slower: the networks are too small to share between threads
    settings = PpoSettings()
    scenario = load_scenario("timing-0.7s")
    task = scenario.task(plan(load_arm(scenario.arm), scenario.movement).reference)
    batch = settings.environments * settings.steps
    ppo = PPO(
        "MlpPolicy",
        Sb3VecEnv(ArmVectorEnv(task, settings.environments)),
        learning_rate=lambda left: left * settings.learning_rate,
        n_steps=settings.steps,
        batch_size=batch // settings.minibatches,
        n_epochs=settings.epochs,
        gamma=settings.gamma,
        gae_lambda=settings.gae_lambda,
        clip_range=settings.clip,
        vf_coef=settings.value_weight,
        max_grad_norm=settings.max_grad_norm,
        policy_kwargs={
            "net_arch": {"pi": list(settings.actor_layers), "vf": list(settings.critic_layers)},
            "activation_fn": torch.nn.Tanh,
            "log_std_init": float(np.log(settings.initial_std)),
        },
        seed=0,
        device="cpu",
    )
    watch = BatchTimes()
    ppo.learn(batches * batch, callback=watch)
    steps = batch / statistics.median(np.diff(watch.times)[1:])  # without the first batch, which warms up
    report(
        "Stable-Baselines3's PPO on ArmVectorEnv",
        arms=settings.environments,
        muscles=len(task.arm.muscles),
        control_step=0.01,
        physics_step=0.001,
        steps=steps,
    )


if __name__ == "__main__":
    main()
