"""Proximal policy optimization (Schulman et al. 2017), from top to bottom.

A batch is collected with the present policy, then used for some epochs of minibatch updates
whose step away from that policy is clipped.
"""

import csv
import math
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, fields
from dataclasses import dataclass as plain_dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import torch
from gymnasium.spaces import Box
from gymnasium.vector import VectorEnv
from pydantic import ConfigDict, Field, NonNegativeInt, PositiveFloat, PositiveInt
from pydantic.dataclasses import dataclass

from drakearm.errors import TrainingError
from drakearm.learning.backprop import separate_weights
from drakearm.learning.learners import ActorLearner, Batch, CriticLearner, learn
from drakearm.learning.policy import Actor, Critic, Policy
from drakearm.learning.rollout import Collector, Rollout, gae

UnitInterval = Annotated[float, Field(ge=0.0, le=1.0)]


@dataclass(frozen=True, config=ConfigDict(extra="forbid", allow_inf_nan=False))
class PpoSettings:
    """How to train. The defaults start from imitation; `PAPER` holds those of the paper, which start from nothing."""

    batches: PositiveInt = 60  # rounds of collecting and updating
    environments: PositiveInt = 64  # arms side by side: what the vector environment must hold
    steps: PositiveInt = 75  # control steps per environment and batch
    epochs: PositiveInt = 5  # passes over a batch
    minibatches: PositiveInt = 4  # updates per pass
    learning_rate: PositiveFloat = 3e-5  # the actor's in the first batch
    target_kl: PositiveFloat | None = 0.02  # nats a batch, kept by the learning rate; None: that falls linearly to zero
    critic_learning_rate: PositiveFloat = 1e-3  # in the first batch, falls linearly to zero
    gamma: UnitInterval = 0.97  # discount per control step
    gae_lambda: UnitInterval = 0.95  # 0: one-step advantages, 1: whole returns
    clip: PositiveFloat = 0.2  # how far an action's probability ratio may usefully leave 1
    max_grad_norm: PositiveFloat = 0.5  # longer gradients are shortened to this
    value_weight: PositiveFloat = 0.5  # of the value loss beside the policy loss
    initial_std: PositiveFloat = 0.05  # of the actions, in their own unit
    final_std: PositiveFloat | None = 0.01  # towards which it falls geometrically; None: it is learned
    imitation_rounds: NonNegativeInt = 4  # of imitating static optimization first; 0: starts from random weights
    initial_action: float = 0.15  # mean of the actions, in their own unit
    actor_layers: tuple[PositiveInt, ...] = (64,) * 5  # widths of the hidden layers, tanh
    critic_layers: tuple[PositiveInt, ...] = (64,) * 3  # widths of the hidden layers, PReLU


PAPER = PpoSettings(
    batches=200,
    environments=32,
    epochs=10,
    minibatches=8,
    learning_rate=1e-3,
    target_kl=None,
    initial_std=0.3,
    final_std=None,
    imitation_rounds=0,
)


@plain_dataclass(frozen=True)
class BatchReport:
    """How the training stands after a batch; a row of the log."""

    batch: int  # from 1
    batches: int
    steps: int  # transitions so far, over all environments
    steps_per_second: float  # in this batch, updates included
    seconds_left: float  # if the other batches take as long as those so far
    mean_reward: float  # mean return of the episodes that ended in this batch; nan if none did
    tracking_error: float  # mean absolute error, rad; nan where environments do not tell
    approx_kl: float  # nats, between the policy that collected and the one being updated
    clip_fraction: float  # share of transitions whose ratio has left the clip range
    explained_variance: float  # of the returns by the critic: 1 perfect, 0 no better than the mean
    policy_loss: float
    value_loss: float
    entropy: float  # nats
    std: float  # of the actions, mean over their elements


@contextmanager
def _one_thread() -> Iterator[None]:
    """Torch computes on one thread meanwhile.

    These networks are too small to share out, and idle threads of a pool spin: with two pools
    on two cores, training was a hundred times slower.
    """
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


@_one_thread()
def train(
    envs: VectorEnv,
    settings: PpoSettings,
    *,
    seed: int,
    metadata: dict[str, Any],
    prepare: Callable[[Actor], None] | None = None,
    log_path: Path | None = None,
    checkpoint_path: Path | None = None,
    on_batch: Callable[[BatchReport], None] | None = None,
) -> Policy:
    """A policy for `envs`, which stay open; the same seed gives the same policy, bit for bit.

    `metadata` goes into the policy. `prepare` may teach the actor before it learns by trying, as
    `imitate` does. `log_path` gets a CSV row a batch, with the fields of
    BatchReport; `checkpoint_path` the policy so far after every batch, before `on_batch` is called with
    the batch's report. Raises TrainingError for environments that PPO
    cannot use and as soon as a number is not finite.
    """
    observation_space, action_space = _suitable_spaces(envs, settings)
    generator = torch.Generator().manual_seed(seed)
    policy = _initial_policy(observation_space, action_space, settings, metadata, generator)
    if prepare:
        prepare(policy.actor)
    policy.to("cuda" if torch.cuda.is_available() else "cpu")
    actor = ActorLearner(policy.actor, settings.max_grad_norm, settings.clip)
    critic = CriticLearner(policy.critic, settings.max_grad_norm, settings.value_weight)
    collector = Collector(envs, settings.steps, seed)

    steps, learning_rate = 0, settings.learning_rate
    start = batch_start = time.perf_counter()
    with ExitStack() as stack:
        write_row = _csv_log(log_path, stack)
        for batch in range(1, settings.batches + 1):
            done = (batch - 1) / settings.batches
            critic.set_learning_rate(settings.critic_learning_rate * (1.0 - done))
            actor.set_learning_rate(learning_rate if settings.target_kl else settings.learning_rate * (1.0 - done))
            if settings.final_std is not None:
                policy.actor.set_std(settings.initial_std ** (1.0 - done) * settings.final_std**done)
            rollout = collector.collect(policy.actor, generator, batch)
            experience, explained_variance = _experience(policy, rollout, settings, generator, batch)
            diagnostics = learn(actor, critic, experience)
            if settings.target_kl:
                learning_rate = _adapted(learning_rate, diagnostics["approx_kl"], settings.target_kl)

            now = time.perf_counter()
            batch_steps = int(rollout.valid.sum())
            steps += batch_steps
            returns = rollout.episode_returns
            report = BatchReport(
                batch=batch,
                batches=settings.batches,
                steps=steps,
                steps_per_second=batch_steps / (now - batch_start),
                seconds_left=(now - start) / batch * (settings.batches - batch),
                mean_reward=float(np.mean(returns)) if returns else math.nan,
                tracking_error=rollout.tracking_error,
                entropy=policy.actor.entropy().item(),
                std=policy.actor.log_std.exp().mean().item(),
                explained_variance=explained_variance,
                **diagnostics,
            )
            batch_start = now
            write_row(report)
            if checkpoint_path:
                policy.save(checkpoint_path)
            if on_batch:
                on_batch(report)
    policy.cpu()
    separate_weights(policy)
    return policy


def _adapted(learning_rate: float, kl: float, target: float) -> float:
    """The learning rate for the next batch, after one whose divergence was kl."""
    if kl > 1.5 * target:
        return learning_rate / 1.5
    return learning_rate * 1.5 if kl < target / 1.5 else learning_rate


def _experience(
    policy: Policy, rollout: Rollout, settings: PpoSettings, generator: torch.Generator, number: int
) -> tuple[Batch, float]:
    """What to learn from a rollout, and how much of the returns' variance the critic explained."""
    device = policy.actor.log_std.device
    observations, valid = rollout.observations.to(device), torch.from_numpy(rollout.valid)
    with torch.no_grad():
        all_values = policy.critic(observations)
        next_values = policy.critic(rollout.successors.to(device))
    all_advantages = gae(
        rollout.rewards,
        all_values.cpu().numpy(),
        next_values.cpu().numpy(),
        rollout.terminated,
        rollout.ended,
        settings.gamma,
        settings.gae_lambda,
    )
    advantages = torch.from_numpy(all_advantages).to(all_values)[valid]
    values = all_values[valid]
    returns = values + advantages
    batch = Batch(
        observations=observations[valid],
        actions=rollout.actions[valid].to(device),
        log_probs=rollout.log_probs[valid].to(device),
        # Over the whole batch: a minibatch's own mean and deviation would be noise on top.
        advantages=(advantages - advantages.mean()) / (advantages.std() + 1e-8),
        returns=returns,
        orders=[torch.randperm(len(returns), generator=generator).to(device) for _ in range(settings.epochs)],
        minibatches=settings.minibatches,
        number=number,
    )
    return batch, (1 - (returns - values).var() / returns.var()).item()


def _initial_policy(
    observation_space: Box,
    action_space: Box,
    settings: PpoSettings,
    metadata: dict[str, Any],
    generator: torch.Generator,
) -> Policy:
    n_observations = observation_space.shape[0]
    actor = Actor(
        n_observations,
        action_space.shape[0],
        settings.actor_layers,
        initial_action=settings.initial_action,
        initial_std=settings.initial_std,
        learns_std=settings.final_std is None,
        generator=generator,
    )
    critic = Critic(n_observations, settings.critic_layers, generator=generator)
    return Policy(actor, critic, action_space.low, action_space.high, metadata)


def _suitable_spaces(envs: VectorEnv, settings: PpoSettings) -> tuple[Box, Box]:
    """The spaces of one observation and one action, if PPO can train on `envs` with `settings`."""
    spaces = []
    for name in ("observation", "action"):
        space = getattr(envs, f"single_{name}_space")
        if not isinstance(space, Box) or len(space.shape) != 1:
            raise TrainingError(f"PPO needs a Box of one axis as {name} space, but found {space}.")
        spaces.append(space)
    if envs.num_envs != settings.environments:
        raise TrainingError(
            f"The settings ask for {settings.environments} environments, "
            f"but the vector environment holds {envs.num_envs}."
        )
    # Half of them, because every other step may be a reset.
    if settings.steps * settings.environments // 2 < settings.minibatches:
        raise TrainingError(
            f"{settings.minibatches} minibatches are too many for batches of {settings.steps} "
            f"steps in {settings.environments} environments."
        )
    return spaces[0], spaces[1]


def _csv_log(path: Path | None, stack: ExitStack) -> Callable[[BatchReport], None]:
    """A function that appends a row to the new file `path`; `stack` closes it."""
    if path is None:
        return lambda report: None
    path.parent.mkdir(parents=True, exist_ok=True)
    file = stack.enter_context(path.open("w", newline=""))
    writer = csv.DictWriter(file, [field.name for field in fields(BatchReport)])
    writer.writeheader()

    def write_row(report: BatchReport) -> None:
        writer.writerow(asdict(report))
        file.flush()  # a training that is watched, or killed, has its log

    return write_row
