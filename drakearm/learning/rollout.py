"""Experience for PPO: transitions from a vector environment, and their advantages.

Arrays are (steps T, environments N, ...), float32. Gymnasium's vector environments reset an environment by themselves
when its episode ends. This module keeps the resets out of the transitions.
"""

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import torch
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray
from torch import Tensor

from drakearm.errors import TrainingError
from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.networks import Actor
from drakearm.learning.passes import passes


def gae(
    rewards: NDArray[Any],
    values: NDArray[Any],
    next_values: NDArray[Any],
    terminated: NDArray[np.bool_],
    ended: NDArray[np.bool_],
    gamma: float,
    lam: float,
) -> NDArray[Any]:
    """Generalized advantage estimates, (T, N) (Schulman et al. 2016, equation 16).

    All arrays are (T, N). next_values: the values of the true successors. At a time limit this is the value of the last
    state, not that of the first state after the reset. terminated: marks transitions into a state without a future,
    whose value counts as 0. ended: marks transitions after which the trajectory stops, terminated or truncated.
    """
    deltas = rewards + gamma * next_values * ~terminated - values
    decay = gamma * lam * ~ended
    advantages = np.empty_like(deltas)
    later = np.zeros_like(deltas[0])
    for t in reversed(range(len(deltas))):
        advantages[t] = later = deltas[t] + decay[t] * later
    return advantages


@dataclass(frozen=True)
class Rollout:
    """The transitions of one batch, in arrays (T, N), and statistics for the report."""

    observations: Tensor  # (T, N, n_obs), scaled, before the action
    actions: Tensor  # (T, N, n_act), as sampled, not clipped to the bounds
    log_probs: Tensor  # log-densities of the actions
    successors: Tensor  # (T, N, n_obs), scaled, after the action and before any reset
    rewards: NDArray[np.float32]
    terminated: NDArray[np.bool_]  # the successor has no future
    ended: NDArray[np.bool_]  # terminated, or truncated by a time limit
    valid: NDArray[np.bool_]  # False for the steps that only reset an environment
    episode_returns: list[float]  # sums of the rewards of the episodes that ended in this batch
    tracking_error: float  # mean absolute error, rad; nan if `info` has no tracking_error


class Collector:
    """Collects `steps` steps of all `envs` per batch. Episodes continue from one batch to the next.

    scaling: of the observations, before the actor gets them and in the rollouts.
    """

    def __init__(self, envs: VectorEnv, steps: int, seed: int, scaling: InputScaling) -> None:
        mode = envs.metadata.get("autoreset_mode")
        if mode not in (AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP):
            raise TrainingError(
                "PPO needs vector environments that reset themselves, with the autoreset mode "
                f"NEXT_STEP or SAME_STEP, but was given {mode}."
            )
        self._envs = envs
        self._steps = steps
        self.scaling = scaling
        self._same_step = mode == AutoresetMode.SAME_STEP
        actions = cast(Box, envs.single_action_space)
        self._low, self._high = actions.low, actions.high
        self._observation, _ = envs.reset(seed=seed)
        self._resets_next = np.zeros(envs.num_envs, dtype=bool)
        self._returns = np.zeros(envs.num_envs)

    @property
    def state(self) -> dict[str, NDArray[Any]]:
        """Where the collecting is, by name, apart from the environments. To set it continues the collecting there."""
        return {
            "observation": self._observation,
            "resets_next": self._resets_next,
            "returns": self._returns,
            "input_mean": self.scaling.mean,
            "input_scale": self.scaling.scale,
        }

    @state.setter
    def state(self, arrays: dict[str, NDArray[Any]]) -> None:
        self._observation, self._resets_next = arrays["observation"], arrays["resets_next"]
        self._returns = arrays["returns"].copy()
        self.scaling = InputScaling(arrays["input_mean"], arrays["input_scale"])

    @torch.no_grad()
    def collect(self, actor: Actor, generator: torch.Generator, batch: int) -> Rollout:
        """The transitions of the next `steps` steps, with actions sampled from `actor`.

        Raises TrainingError, which names `batch`, if an observation or a reward is not finite.
        """
        # Torch allocates the memory because it aligns it: results of matrix products depend on the alignment.
        shape = (self._steps, self._envs.num_envs)
        observations = torch.empty(*shape, self._observation.shape[-1])
        successors = torch.empty_like(observations)
        before, after = observations.numpy(), successors.numpy()  # the same memory
        rewards = np.empty(shape, np.float32)
        terminated, ended, valid = (np.empty(shape, bool) for _ in range(3))
        device = actor.log_std.device
        noise = torch.randn(*shape, len(self._low), generator=generator)
        log_probs = actor.log_density(noise.to(device)).cpu()
        actions = noise.mul_(actor.log_std.exp().cpu())  # the loop below adds the means
        mean = passes(actor.mean).forward  # less overhead than the module's own call, which counts for few rows
        episode_returns: list[float] = []
        errors: list[NDArray[Any]] = []

        scaled = self.scaling(self._observation)
        for t in range(self._steps):
            before[t] = scaled
            _require_finite(before[t], "an observation", batch)
            actions[t] += mean(observations[t].to(device)).cpu()
            bounded = actions[t].numpy().clip(self._low, self._high)
            observation, reward, terminal, truncated, infos = self._envs.step(bounded)

            ended_now = terminal | truncated
            moved = ~self._resets_next
            after[t] = scaled = self.scaling(observation)
            if self._same_step and ended_now.any():
                after[t, ended_now] = self.scaling(np.stack(infos["final_obs"][ended_now]))
            rewards[t], terminated[t], ended[t], valid[t] = reward, terminal, ended_now, moved
            errors += _tracking_errors(infos, moved)

            self._returns += reward * moved
            episode_returns += self._returns[ended_now].tolist()
            self._returns[ended_now] = 0.0
            self._observation = observation
            if not self._same_step:
                self._resets_next = ended_now

        _require_finite(after, "an observation", batch)
        _require_finite(rewards, "a reward", batch)
        return Rollout(
            observations=observations,
            actions=actions,
            log_probs=log_probs,
            successors=successors,
            rewards=rewards,
            terminated=terminated,
            ended=ended,
            valid=valid,
            episode_returns=episode_returns,
            tracking_error=float(np.concatenate(errors).mean()) if errors else float("nan"),
        )


def _require_finite(values: NDArray[Any], name: str, batch: int) -> None:
    if not np.isfinite(values).all():
        raise TrainingError(f"The environments returned {name} that is not finite in batch {batch}.")


def _tracking_errors(infos: dict[str, Any], moved: NDArray[np.bool_]) -> list[NDArray[Any]]:
    """The absolute tracking errors of the environments that `moved` and reported an error, as flat arrays.

    If Gymnasium has reset an environment in the same step, the info of its last transition is in `final_info`.
    """
    errors = []
    for info in (infos.get("final_info", {}), infos):
        if "tracking_error" in info:
            reported = moved & info.get("_tracking_error", True)
            errors.append(np.abs(info["tracking_error"][reported]).ravel())
            moved = moved & ~reported
    return errors
