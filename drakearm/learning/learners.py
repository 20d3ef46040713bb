"""How the actor and the critic learn from a batch: the losses of PPO with their gradients, and Adam.

The two networks share nothing, so each learns in a thread of its own, one core each.
"""

import math
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
    orders: list[tuple[Tensor, ...]]  # for each epoch, the rows of each minibatch
    number: int  # of the batch, for messages

    @property
    def rows(self) -> int:
        """The most that a minibatch has."""
        return max(len(rows) for order in self.orders for rows in order)


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
        norm = nn.utils.clip_grad_norm_(self._weights, self._max_grad_norm)
        if not norm.isfinite():  # nor is it where the loss is not
            raise TrainingError(
                f"The gradient of the loss is not finite in {where}: "
                "a smaller learning rate or smaller rewards may help."
            )
        self._optimizer.step()


class ActorLearner(Learner):
    """Policy gradient with clipped probability ratios (Schulman et al. 2017, eq. 7)."""

    def __init__(self, actor: Actor, max_grad_norm: float, clip: float) -> None:
        super().__init__(actor, max_grad_norm)
        self._actor, self._clip = actor, clip

    @torch.no_grad()
    def learn(self, batch: Batch) -> dict[str, float]:
        """Goes through all minibatches; returns diagnostics, means over them."""
        actor, backprop = self._actor, Backprop(self._actor.mean, batch.rows)
        sums = torch.zeros(3, device=batch.advantages.device)
        steps = 0
        for order in batch.orders:
            for rows in order:
                gain = batch.advantages[rows]
                inverse_std = torch.exp(-actor.log_std)
                z = (batch.actions[rows] - backprop.forward(batch.observations[rows])) * inverse_std
                log_scale = actor.log_std.sum() + 0.5 * math.log(2.0 * math.pi) * actor.log_std.numel()
                log_ratio = -0.5 * z.square().sum(1) - log_scale - batch.log_probs[rows]
                ratio = log_ratio.exp()
                clipped = ratio.clamp(1.0 - self._clip, 1.0 + self._clip)
                surrogate = torch.minimum(ratio * gain, clipped * gain)
                # The loss is -mean(surrogate); where the clipped product is the smaller one, its slope is 0.
                # NaN is not greater than anything: it goes on into the gradient, where it is noticed.
                by_log_prob = torch.where(ratio * gain > clipped * gain, 0.0, ratio * gain) / -len(gain)
                backprop.backward(by_log_prob[:, None] * z * inverse_std)
                if actor.learns_std:
                    gradient(actor.log_std).copy_(by_log_prob @ (z.square() - 1.0))
                self.step(f"batch {batch.number}")
                approx_kl = (ratio - 1.0 - log_ratio).mean()  # Schulman 2020, estimator k3
                clip_fraction = (ratio != clipped).float().mean()
                sums += torch.stack([-surrogate.mean(), approx_kl, clip_fraction])
                steps += 1
        return dict(zip(("policy_loss", "approx_kl", "clip_fraction"), (sums / steps).tolist(), strict=True))


class CriticLearner(Learner):
    """Least squares on the returns."""

    def __init__(self, critic: Critic, max_grad_norm: float, weight: float) -> None:
        super().__init__(critic, max_grad_norm)
        self._critic, self._weight = critic, weight

    @torch.no_grad()
    def learn(self, batch: Batch) -> dict[str, float]:
        """Goes through all minibatches; returns the loss, mean over them."""
        backprop = Backprop(self._critic.value, batch.rows)
        total = torch.zeros((), device=batch.returns.device)
        steps = 0
        for order in batch.orders:
            for rows in order:
                error = backprop.forward(batch.observations[rows])[:, 0] - batch.returns[rows]
                backprop.backward((2.0 * self._weight / len(error) * error)[:, None])
                self.step(f"batch {batch.number}")
                total += error.square().mean()
                steps += 1
        return {"value_loss": (total / steps).item()}


def learn(actor: ActorLearner, critic: CriticLearner, batch: Batch) -> dict[str, float]:
    """Lets both learn from a batch, side by side; returns the diagnostics of both."""
    with ThreadPoolExecutor(1) as pool:
        values = pool.submit(critic.learn, batch)
        return actor.learn(batch) | values.result()
