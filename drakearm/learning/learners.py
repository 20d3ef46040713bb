"""How the actor and the critic learn from a batch: the losses of PPO with their gradients, and Adam.

The two networks share nothing, so each learns in a thread of its own, one core each.
"""

import math
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from drakearm.errors import TrainingError
from drakearm.learning.backprop import Backprop, flat_weights, gradient
from drakearm.learning.policy import Actor, Critic


@dataclass(frozen=True)
class Batch:
    """The transitions to learn from, a row each, and the orders in which to go through them."""

    observations: Tensor  # (n, n_obs)
    actions: Tensor  # (n, n_act), not clipped
    log_probs: Tensor  # (n,), of the actions when they were taken
    advantages: Tensor  # (n,), of mean 0 and deviation 1
    returns: Tensor  # (n,)
    orders: list[Tensor]  # for each epoch, the order in which to go through the rows
    minibatches: int  # of every epoch
    number: int  # of the batch, for messages

    def split(self, *fields: Tensor) -> Iterator[tuple[Tensor, ...]]:
        """Some of the fields, minibatch after minibatch, epoch after epoch."""
        for order in self.orders:
            shuffled = [field.index_select(0, order).tensor_split(self.minibatches) for field in fields]
            yield from zip(*shuffled, strict=True)


class Learner:
    """A network's weights with Adam, whose gradients are shortened to max_grad_norm."""

    def __init__(self, network: nn.Module, max_grad_norm: float) -> None:
        self._weights = flat_weights(network)
        self._optimizer = torch.optim.Adam([self._weights], fused=True)
        self._max_grad_norm = max_grad_norm

    def set_learning_rate(self, learning_rate: float) -> None:
        self._optimizer.param_groups[0]["lr"] = learning_rate

    def step(self, where: str) -> None:
        """Follows the gradient. Raises TrainingError, which tells where, if it is not finite."""
        by_weights = gradient(self._weights)
        norm = torch.linalg.vector_norm(by_weights).item()
        if not math.isfinite(norm):  # nor is it where the loss is not
            raise TrainingError(
                f"The gradient of the loss is not finite in {where}: "
                "a smaller learning rate or smaller rewards may help."
            )
        if norm > self._max_grad_norm:
            by_weights *= self._max_grad_norm / norm
        self._optimizer.step()


class ActorLearner(Learner):
    """Policy gradient with clipped probability ratios (Schulman et al. 2017, eq. 7)."""

    def __init__(self, actor: Actor, max_grad_norm: float, clip: float) -> None:
        super().__init__(actor, max_grad_norm)
        self._actor, self._clip = actor, clip

    @torch.no_grad()
    def learn(self, batch: Batch) -> dict[str, float]:
        """Goes through all minibatches; returns diagnostics, means over them."""
        actor, backprop = self._actor, Backprop(self._actor.mean)
        log_ratios, surrogates = [], []
        for observations, actions, log_probs, gain in batch.split(
            batch.observations, batch.actions, batch.log_probs, batch.advantages
        ):
            inverse_std = torch.exp(-actor.log_std)
            z = (actions - backprop.forward(observations)) * inverse_std
            log_ratio = actor.log_density(z) - log_probs
            ratio = log_ratio.exp()
            whole, clipped = ratio * gain, ratio.clamp(1.0 - self._clip, 1.0 + self._clip) * gain
            # The loss is -mean(minimum(whole, clipped)); where clipped is the smaller one, its slope is 0.
            # NaN is not greater than anything: it goes on into the gradient, where it is noticed.
            by_log_prob = torch.where(whole > clipped, 0.0, whole) / -len(gain)
            backprop.backward(by_log_prob[:, None] * z * inverse_std)
            if actor.learns_std:
                gradient(actor.log_std).copy_(by_log_prob @ (z.square() - 1.0))
            self.step(f"batch {batch.number}")
            log_ratios.append(log_ratio)
            surrogates.append(torch.minimum(whole, clipped))
        log_ratio = torch.cat(log_ratios)
        ratio = log_ratio.exp()
        return {
            "policy_loss": -torch.cat(surrogates).mean().item(),
            "approx_kl": (ratio - 1.0 - log_ratio).mean().item(),  # Schulman 2020, estimator k3
            "clip_fraction": ((ratio - 1.0).abs() > self._clip).float().mean().item(),
        }


class CriticLearner(Learner):
    """Least squares on the returns."""

    def __init__(self, critic: Critic, max_grad_norm: float, weight: float) -> None:
        super().__init__(critic, max_grad_norm)
        self._critic, self._weight = critic, weight

    @torch.no_grad()
    def learn(self, batch: Batch) -> dict[str, float]:
        """Goes through all minibatches; returns the loss, mean over them."""
        backprop = Backprop(self._critic.value)
        errors = []
        for observations, returns in batch.split(batch.observations, batch.returns):
            error = backprop.forward(observations)[:, 0] - returns
            backprop.backward((2.0 * self._weight / len(error) * error)[:, None])
            self.step(f"batch {batch.number}")
            errors.append(error)
        return {"value_loss": torch.cat(errors).square().mean().item()}


def learn(actor: ActorLearner, critic: CriticLearner, batch: Batch) -> dict[str, float]:
    """Lets both learn from a batch, side by side; returns the diagnostics of both."""
    with ThreadPoolExecutor(1) as pool:
        values = pool.submit(critic.learn, batch)
        return actor.learn(batch) | values.result()
