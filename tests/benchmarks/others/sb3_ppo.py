"""Stable-Baselines3's PPO on drakearm's vector environment, with drakearm's default settings, collecting and updating.

Run it with `python sb3_ppo.py`, with drakearm and stable-baselines3 installed. Its networks have the sizes of
drakearm's. The activation function of its critic is tanh, that of drakearm's is PReLU. It also prints which share
of the time `Sb3VecEnv` takes, beside the arms.
"""

import statistics
import sys
import time

import numpy as np
import torch

try:
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback

    from drakearm.learning.sb3 import Sb3VecEnv
except ImportError:
    sys.exit("not installed: pip install stable-baselines3")
from rates import is_quick, report

from drakearm.experiments.scenario import load_scenario
from drakearm.learning import ArmVectorEnv, PpoSettings
from drakearm.model import load_arm
from drakearm.planning import plan

BATCHES, QUICK_BATCHES = 8, 3


class TimedSteps(Sb3VecEnv):
    """Sums up the seconds that its steps take, and those of them that the arms take."""

    seconds = arms_seconds = 0.0

    def __init__(self, envs: ArmVectorEnv):
        super().__init__(envs)
        step = envs.step

        def timed(actions: np.ndarray) -> tuple:
            began = time.perf_counter()
            result = step(actions)
            self.arms_seconds += time.perf_counter() - began
            return result

        envs.step = timed  # type: ignore[method-assign]

    def step_wait(self) -> tuple:
        began = time.perf_counter()
        result = super().step_wait()
        self.seconds += time.perf_counter() - began
        return result


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
    envs = TimedSteps(ArmVectorEnv(task, settings.environments))
    ppo = PPO(
        "MlpPolicy",
        envs,
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
    began = time.perf_counter()
    ppo.learn(batches * batch, callback=watch)
    share = (envs.seconds - envs.arms_seconds) / (time.perf_counter() - began)
    print(f"Sb3VecEnv takes {100 * share:.1f} % of the time", file=sys.stderr)
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
