"""Imitation: before PPO, an actor learns to choose the same excitations as static optimization.

Dataset aggregation (Ross, Gordon and Bagnell 2011): the actor moves the arms, with noise on its excitations. At every
state that is reached, the label is what the expert would choose there. So the actor also learns to return to the
reference after an error.
"""

from collections.abc import Callable, Sequence

import numpy as np
import torch

from drakearm.learning.arm_vector_env import ArmVectorEnv
from drakearm.learning.expert import STIFFNESS, StaticExpert
from drakearm.learning.input_scaling import InputScaling
from drakearm.learning.learners import Learner
from drakearm.learning.networks import Actor
from drakearm.learning.passes import passes
from drakearm.learning.rehearsal import rehearse
from drakearm.task import TrackingTask

EPOCHS = 20  # per round, over the samples of all rounds so far
MINIBATCH = 600  # samples
LEARNING_RATE = 2e-3  # at the start of every round, in which it falls linearly towards a tenth
NOISE = 0.1  # standard deviation, on the excitations of the last arm; it grows linearly from 0, for the first arm


def imitate(
    actor: Actor,
    tasks: Sequence[TrackingTask],
    rounds: int,
    seed: int,
    on_round: Callable[[int], None] | None = None,
    arms: int = 64,
    stiffness: float = STIFFNESS,
) -> InputScaling:
    """Trains an actor in place. The same seed gives the same weights. Returns the scaling of the actor's inputs.

    tasks: assigned to the arms round-robin, or drawn if there are more of them than arms, as in `ArmVectorEnv`. The
    expert rehearses them. It moves the arms in the first round, and the actor in later rounds. The observations of the
    first round give the scaling. on_round: called after each round with its number, from 1. stiffness: 1/s^2, of the
    expert's feedback.
    """
    envs = ArmVectorEnv(tasks, arms, redraw=len(tasks) > arms)
    expert = StaticExpert(envs, rehearse(tasks, stiffness), stiffness)
    scaling = InputScaling.none(tasks[0].observation.size)
    learner = Learner(actor, max_grad_norm=1.0)
    generator = torch.Generator().manual_seed(seed)
    all_observations: list[torch.Tensor] = []
    all_excitations: list[torch.Tensor] = []
    for number in range(1, rounds + 1):
        observations, excitations = _collect(envs, expert, None if number == 1 else actor, scaling, seed + number)
        if number == 1:
            scaling = InputScaling.of(observations.numpy())
            observations = torch.tensor(scaling(observations.numpy()))
        all_observations.append(observations)
        all_excitations.append(excitations)
        _fit(actor, learner, torch.cat(all_observations), torch.cat(all_excitations), generator)
        if on_round:
            on_round(number)
    return scaling


def _collect(
    envs: ArmVectorEnv, expert: StaticExpert, actor: Actor | None, scaling: InputScaling, seed: int
) -> tuple[torch.Tensor, torch.Tensor]:
    """Scaled observations and the expert's excitations in one episode per arm. Without an actor, the expert moves."""
    rng = np.random.default_rng(seed)
    noise = np.linspace(0.0, NOISE, envs.num_envs)[:, None]
    observation, info = envs.reset(seed=seed)
    observations, excitations = [], []
    moving = np.ones(envs.num_envs, dtype=bool)
    while moving.any():
        desired = expert.act(info["arm_state"], info["activation"])
        inputs = torch.tensor(scaling(observation))  # a copy, in memory that torch aligns
        observations.append(inputs[moving])
        excitations.append(torch.tensor(desired[moving], dtype=torch.float32))
        with torch.no_grad():
            action = desired if actor is None else actor(inputs).numpy()
        action = np.clip(action + noise * rng.standard_normal(action.shape), 0.0, 1.0)
        observation, _, _, truncated, info = envs.step(action)
        moving &= ~truncated
    return torch.cat(observations), torch.cat(excitations)


@torch.no_grad()
def _fit(
    actor: Actor, learner: Learner, observations: torch.Tensor, excitations: torch.Tensor, generator: torch.Generator
) -> None:
    """Fits the actor's mean to the expert's excitations by least squares: the loss is the mean squared error."""
    backprop = passes(actor.mean)
    minibatches = max(1, len(observations) // MINIBATCH)
    for epoch in range(EPOCHS):
        learner.set_learning_rate(LEARNING_RATE * (1.0 - 0.9 * epoch / EPOCHS))
        for rows in torch.randperm(len(observations), generator=generator).tensor_split(minibatches):
            error = backprop.forward(observations[rows]) - excitations[rows]
            backprop.backward(2.0 / error.numel() * error)
            learner.step("imitation")
