"""Imitation: an actor learns what static optimization does, before it learns by trying.

Dataset aggregation (Ross, Gordon and Bagnell 2011): the actor's own movements, a little disturbed, are labeled with
what the expert would have done there, so that it also learns to come back.
"""

from collections.abc import Callable, Sequence

import numpy as np
import torch

from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.learning.backprop import Backprop
from drakearm.learning.expert import StaticExpert
from drakearm.learning.learners import Learner
from drakearm.learning.policy import Actor
from drakearm.task import TrackingTask

ARMS = 64
EPOCHS = 20  # after each round, over all that was seen so far
MINIBATCH = 600
LEARNING_RATE = 2e-3  # falls linearly to a tenth in every round
NOISE = 0.2  # standard deviation of the excitations' disturbance for the most disturbed arm; for the first one it is 0


def imitate(
    actor: Actor,
    tasks: Sequence[TrackingTask],
    rounds: int,
    seed: int,
    on_round: Callable[[int], None] | None = None,
) -> None:
    """Teaches an actor, in place; the same seed gives the same weights.

    In the first round the expert moves the arms, in the others the actor does. on_round: called at the end of each
    round with its number, from 1.
    """
    envs, expert = ArmVectorEnv(tasks, max(ARMS, len(tasks))), StaticExpert(tasks, max(ARMS, len(tasks)))
    learner = Learner(actor, max_grad_norm=1.0)
    generator = torch.Generator().manual_seed(seed)
    seen: list[torch.Tensor] = []
    done: list[torch.Tensor] = []
    for number in range(1, rounds + 1):
        observations, excitations = _round(envs, expert, None if number == 1 else actor, seed + number)
        seen.append(observations)
        done.append(excitations)
        _fit(actor, learner, torch.cat(seen), torch.cat(done), generator)
        if on_round:
            on_round(number)


def _round(
    envs: ArmVectorEnv, expert: StaticExpert, actor: Actor | None, seed: int
) -> tuple[torch.Tensor, torch.Tensor]:
    """Observations and the expert's excitations while the actor, or the expert itself, moves every arm once."""
    rng = np.random.default_rng(seed)
    noise = np.linspace(0.0, NOISE, envs.num_envs)[:, None]
    observation, info = envs.reset(seed=seed)
    seen, done = [], []
    moving = np.ones(envs.num_envs, dtype=bool)
    while moving.any():
        desired = expert.act(info["arm_state"], info["activation"], envs.reference_step)
        inputs = torch.tensor(observation)  # a copy, whose memory torch aligns
        seen.append(inputs[moving])
        done.append(torch.tensor(desired[moving], dtype=torch.float32))
        with torch.no_grad():
            action = desired if actor is None else actor(inputs).numpy()
        action = np.clip(action + noise * rng.standard_normal(action.shape), 0.0, 1.0)
        observation, _, _, truncated, info = envs.step(action)
        moving &= ~truncated
    return torch.cat(seen), torch.cat(done)


@torch.no_grad()
def _fit(
    actor: Actor, learner: Learner, observations: torch.Tensor, excitations: torch.Tensor, generator: torch.Generator
) -> None:
    """Least squares on the expert's excitations."""
    backprop = Backprop(actor.mean)
    minibatches = max(1, len(observations) // MINIBATCH)
    for epoch in range(EPOCHS):
        learner.set_learning_rate(LEARNING_RATE * (1.0 - 0.9 * epoch / EPOCHS))
        for rows in torch.randperm(len(observations), generator=generator).tensor_split(minibatches):
            error = backprop.forward(observations[rows]) - excitations[rows]
            backprop.backward(2.0 / error.numel() * error)
            learner.step("imitation")
