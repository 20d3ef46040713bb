"""Proximal policy optimization, PPO (Schulman et al. 2017). To read it, begin with `train`.

The current policy collects a batch of transitions. Several epochs of minibatch updates then change the policy. The
clipped objective gives no gain for moving far away from the policy that collected the batch. The losses and their
gradients are in `drakearm.learning.learners`.
"""

import json
import math
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import torch
from gymnasium.spaces import Box
from gymnasium.vector import VectorEnv

from drakearm.errors import TrainingError, shown
from drakearm.learning.batch_report import BatchReport, csv_log
from drakearm.learning.checkpoint import Checkpoint, Environments, TorchGenerator
from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.learners import ActorLearner, Batch, CriticLearner, learn
from drakearm.learning.module_policy import ModulePolicy, Networks, own_networks
from drakearm.learning.networks import Actor, Critic, policy_of
from drakearm.learning.policy import Policy
from drakearm.learning.ppo_settings import PpoSettings
from drakearm.learning.preparation import default_preparation
from drakearm.learning.rollout import Collector, Rollout, gae
from drakearm.learning.threads import one_thread
from drakearm.learning.warm_start import warm_start


@one_thread()
def train(
    envs: VectorEnv,
    settings: PpoSettings,
    *,
    seed: int,
    metadata: dict[str, Any] | None = None,
    prepare: Callable[[Actor], InputScaling] | None = None,
    initial_policy: Policy | None = None,
    networks: Networks | None = None,
    device: str | None = None,
    log_path: Path | str | None = None,
    checkpoint_path: Path | str | None = None,
    resume_path: Path | str | None = None,
    on_batch: Callable[[BatchReport], object] | None = None,
) -> Policy:
    """Trains a policy on `envs`, which stay open. The same seed gives the same policy, bit for bit.

    What comes before PPO: with an ArmVectorEnv, the actor imitates static optimization for as many rounds as the
    settings say, or a survey shows how to scale the inputs (`drakearm.learning.prepare`). Other environments have no
    tasks: their inputs are not scaled, and the settings must have no rounds of imitation. prepare: replaces this. It
    may train the actor, and returns the scaling of the inputs. initial_policy: replaces it too: the training begins
    with the weights of this policy, see `warm_start`. The new policy takes unscaled observations.

    metadata: is stored in the policy.
    networks: makes modules of PyTorch from the numbers of observations and actions, the actor's mean and the critic's
    value; the policy is a `ModulePolicy` then, and the settings' layers are not used. device: of PyTorch, such as "cpu"
    or "cuda"; by default CUDA where there is any.
    log_path: gets one CSV row per batch, with the fields of BatchReport. checkpoint_path: gets the current policy after
    every batch. resume_path: gets all that the training needs to continue after every batch. If the file exists
    already, the training continues from it, and ends with the same policy as if it had never stopped. It must have the
    same settings. Another number of batches would be another training, because learning rates and exploration fall
    from the first batch to the last one; to train a policy further, give it as initial_policy.
    on_batch: called after every batch with its report; the files are written before. If it returns False, the training
    ends with the policy so far. What it raises ends the training too, and leaves the files.

    Raises TrainingError if PPO cannot use the environments, settings, networks, initial policy or seed, when an
    observation, a reward or a gradient is not finite, and if the file to continue from is damaged or belongs to a
    training with another seed, settings or metadata.
    """
    metadata = metadata or {}
    log_file, policy_file, resume_file = (
        None if path is None else Path(path) for path in (log_path, checkpoint_path, resume_path)
    )
    if prepare and initial_policy:
        raise TrainingError("Found prepare and initial_policy: expected one of them.")
    observation_space, action_space = _suitable_spaces(envs, settings)
    if not 0 <= seed < 2**32:
        raise TrainingError(f"The seed is {shown(seed)}: expected a whole number from 0 to 2**32 - 1.")
    generator = torch.Generator().manual_seed(seed)
    n_observations, n_actions = observation_space.shape[0], action_space.shape[0]
    if networks is None:
        actor, critic = _initial_networks(n_observations, n_actions, settings, generator)
    else:
        std, learns_std = settings.initial_std, settings.final_std is None
        actor, critic = own_networks(networks, n_observations, n_actions, seed, std, learns_std)
    inputs = json.loads(json.dumps({"seed": seed, "settings": asdict(settings), "metadata": metadata}))
    earlier = _earlier(resume_file, inputs)
    if earlier is not None:
        scaling = InputScaling.none(n_observations)  # until that of the checkpoint replaces it
    elif initial_policy:
        scaling = warm_start(initial_policy, actor, critic, envs, settings.steps, seed)
    elif prepare:
        scaling = prepare(actor)
    else:
        scaling = default_preparation(actor, envs, settings, seed)
    for network in (actor, critic):
        network.to(_device(device))
    actor_learner = ActorLearner(actor, settings.max_grad_norm, settings.clip)
    critic_learner = CriticLearner(critic, settings.max_grad_norm, settings.value_weight)
    collector = Collector(envs, settings.steps, seed, scaling)

    def policy() -> Policy:
        bounds = action_space.low, action_space.high
        if networks is None:
            return policy_of(actor, critic, *bounds, metadata, collector.scaling)
        return ModulePolicy(actor, critic, n_observations, *bounds, metadata, collector.scaling)

    parts: dict[str, Any] = {"actor": actor_learner, "critic": critic_learner}
    parts |= {"collector": collector, "generator": TorchGenerator(generator)}
    if resume_file:
        parts["environments"] = Environments(envs)
    finished, steps, learning_rate = 0, 0, settings.learning_rate
    if earlier is not None:
        earlier.restore(parts)
        finished, steps = int(earlier.progress["batch"]), int(earlier.progress["steps"])
        learning_rate = earlier.progress["learning_rate"]

    start = batch_start = time.perf_counter()
    with ExitStack() as stack:
        write_row = csv_log(log_file, finished, stack)
        for batch in range(finished + 1, settings.batches + 1):
            done = (batch - 1) / settings.batches
            critic_learner.set_learning_rate(settings.critic_learning_rate * (1.0 - done))
            actor_learns = done >= settings.critic_share
            rate = learning_rate if settings.target_kl else settings.learning_rate * (1.0 - done)
            actor_learner.set_learning_rate(rate if actor_learns else 0.0)
            if settings.final_std is not None:
                actor.set_std(settings.initial_std ** (1.0 - done) * settings.final_std**done)
            rollout = collector.collect(actor, generator, batch)
            experience, explained_variance = _experience(critic, rollout, settings, generator, batch)
            diagnostics = learn(actor_learner, critic_learner, experience)
            if settings.target_kl and actor_learns:
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
                seconds_left=(now - start) / (batch - finished) * (settings.batches - batch),
                mean_reward=float(np.mean(returns)) if returns else math.nan,
                tracking_error=rollout.tracking_error,
                entropy=actor.entropy().item(),
                std=actor.log_std.exp().mean().item(),
                explained_variance=explained_variance,
                **diagnostics,
            )
            batch_start = now
            write_row(report)
            if policy_file:
                policy().save(policy_file)
            if resume_file:
                checkpoint = Checkpoint(inputs, {"batch": batch, "steps": steps, "learning_rate": learning_rate})
                checkpoint.add(parts)
                checkpoint.save(resume_file)
            if on_batch and on_batch(report) is False:
                break
    return policy()


def _adapted(learning_rate: float, kl: float, target: float) -> float:
    """The learning rate for the next batch. kl: the divergence of the last batch. target: the desired divergence."""
    if kl > 1.5 * target:
        return learning_rate / 1.5
    return learning_rate * 1.5 if kl < target / 1.5 else learning_rate


def _experience(
    critic: Critic, rollout: Rollout, settings: PpoSettings, generator: torch.Generator, number: int
) -> tuple[Batch, float]:
    """A rollout with advantages and returns, and the share of the returns' variance that the critic explains."""
    device = next(critic.parameters()).device
    observations, valid = rollout.observations.to(device), torch.from_numpy(rollout.valid)
    with torch.no_grad():
        all_values = critic(observations)
        next_values = critic(rollout.successors.to(device))
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
        # Normalized over the whole batch: the mean and deviation of each minibatch would add noise.
        advantages=(advantages - advantages.mean()) / (advantages.std() + 1e-8),
        returns=returns,
        orders=[torch.randperm(len(returns), generator=generator).to(device) for _ in range(settings.epochs)],
        minibatches=settings.minibatches,
        number=number,
    )
    return batch, (1 - (returns - values).var() / returns.var()).item()


def _initial_networks(
    n_observations: int, n_actions: int, settings: PpoSettings, generator: torch.Generator
) -> tuple[Actor, Critic]:
    actor = Actor(
        n_observations,
        n_actions,
        settings.actor_layers,
        initial_action=settings.initial_action,
        initial_std=settings.initial_std,
        learns_std=settings.final_std is None,
        generator=generator,
    )
    return actor, Critic(n_observations, settings.critic_layers, generator=generator)


def _device(name: str | None) -> torch.device:
    """The device with this name. Raises TrainingError if there is none."""
    if name is None:
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    try:
        return torch.empty(0, device=name).device
    except (RuntimeError, AssertionError) as error:  # PyTorch without CUDA raises an AssertionError
        raise TrainingError(
            f"PyTorch has no device {shown(name)}: expected cpu, or cuda with a graphics card."
        ) from error


def _suitable_spaces(envs: VectorEnv, settings: PpoSettings) -> tuple[Box, Box]:
    """The spaces of one observation and one action. Raises TrainingError if PPO cannot train with these."""
    if not isinstance(envs, VectorEnv):
        raise TrainingError(
            f"PPO needs a vector environment, such as ArmVectorEnv or what gymnasium.make_vec makes, but was given "
            f"{type(envs).__name__}."
        )
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
    # Only half of the steps are sure to be transitions: with NEXT_STEP, every second step may be a reset.
    if settings.steps * settings.environments // 2 < settings.minibatches:
        raise TrainingError(
            f"{settings.minibatches} minibatches are too many for batches of {settings.steps} "
            f"steps in {settings.environments} environments."
        )
    return spaces[0], spaces[1]


def _earlier(path: Path | None, inputs: dict[str, Any]) -> Checkpoint | None:
    """The checkpoint to continue from, if there is one. Raises TrainingError if it belongs to another training."""
    if path is None or not path.exists():
        return None
    earlier = Checkpoint.load(path)
    different = _differences("", earlier.inputs, inputs)
    if different:
        raise TrainingError(
            f"{shown(path)} is from a training with another {' and '.join(different)}: expected the same."
        )
    return earlier


def _differences(start: str, earlier: Any, present: Any) -> list[str]:
    """The names of fields that differ, with both values. start: of the names."""
    if isinstance(earlier, dict) and isinstance(present, dict):
        fields = dict.fromkeys((*present, *earlier))
        return [d for f in fields for d in _differences(f"{start}{f}.", earlier.get(f), present.get(f))]
    return [] if earlier == present else [f"{start.rstrip('.')} ({shown(earlier)} instead of {shown(present)})"]
