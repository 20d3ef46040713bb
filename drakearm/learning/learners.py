"""How the actor and the critic learn from a batch: the losses of PPO with their gradients, and Adam.

The two networks share no weights, so each learns in its own thread, on its own core.
"""

import math
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from drakearm.errors import TrainingError
from drakearm.learning.backprop import flat_weights, gradient
from drakearm.learning.networks import Actor, Critic
from drakearm.learning.passes import passes

_MOMENTS = ("step", "exp_avg", "exp_avg_sq")  # what Adam remembers


@dataclass(frozen=True)
class Batch:
    """The transitions to learn from, one per row, and the order of the rows in each epoch."""

    observations: Tensor  # (n, n_obs)
    actions: Tensor  # (n, n_act), not clipped
    log_probs: Tensor  # (n,), of the actions when they were taken
    advantages: Tensor  # (n,), with mean 0 and standard deviation 1
    returns: Tensor  # (n,)
    orders: list[Tensor]  # for each epoch, a permutation of the rows
    minibatches: int  # per epoch
    number: int  # of the batch, from 1, for error messages

    def split(self, *fields: Tensor) -> Iterator[tuple[Tensor, ...]]:
        """The given fields of one minibatch after the other, for all epochs."""
        for order in self.orders:
            shuffled = [field.index_select(0, order).tensor_split(self.minibatches) for field in fields]
            yield from zip(*shuffled, strict=True)


class Learner:
    """A network's weights and Adam. A gradient that is longer than max_grad_norm is scaled down to this norm."""

    def __init__(self, network: nn.Module, max_grad_norm: float) -> None:
        self._weights = flat_weights(network)
        self._optimizer = torch.optim.Adam([self._weights], fused=True)
        self._max_grad_norm = max_grad_norm

    def set_learning_rate(self, learning_rate: float) -> None:
        self._optimizer.param_groups[0]["lr"] = learning_rate

    @property
    def state(self) -> dict[str, np.ndarray]:
        """The weights and the moments of Adam, by name. To set them continues the learning where it was."""
        moments = self._optimizer.state[self._weights]
        return {name: moments[name].cpu().numpy() for name in _MOMENTS} | {"weights": self._weights.data.cpu().numpy()}

    @state.setter
    def state(self, arrays: dict[str, np.ndarray]) -> None:
        self._weights.data.copy_(torch.from_numpy(arrays["weights"]))
        moments = {name: torch.from_numpy(arrays[name].copy()).to(self._weights.device) for name in _MOMENTS}
        self._optimizer.state[self._weights] = moments

    def step(self, where: str) -> None:
        """Makes one step of Adam. Raises TrainingError, which says `where`, if the gradient is not finite."""
        by_weights = gradient(self._weights)
        norm = torch.linalg.vector_norm(by_weights).item()
        if not math.isfinite(norm):  # this also finds a loss that is not finite
            raise TrainingError(
                f"The gradient of the loss is not finite in {where}: "
                "a smaller learning rate or smaller rewards may help."
            )
        if norm > self._max_grad_norm:
            by_weights *= self._max_grad_norm / norm
        self._optimizer.step()


class ActorLearner(Learner):
    """Learns the actor with the clipped objective of PPO (Schulman et al. 2017).

    With the probability ratio r = pi(a | s) / pi_old(a | s) of an action a after an observation s, its advantage A, and
    epsilon = `clip`, the loss is minus the objective of their eq. 7, averaged over the n transitions of a minibatch:

        L = -mean(min(r A, clip(r, 1 - epsilon, 1 + epsilon) A))

    pi_old is the actor that collected the batch. There is no entropy bonus (c_2 = 0 in their eq. 9), and the critic has
    a loss of its own. Denizdurduran et al. (2022) learn with the same clipping; their epsilon is 0.2.
    """

    def __init__(self, actor: Actor, max_grad_norm: float, clip: float) -> None:
        super().__init__(actor, max_grad_norm)
        self._actor, self._clip = actor, clip

    @torch.no_grad()
    def learn(self, batch: Batch) -> dict[str, float]:
        """Makes one step per minibatch. Returns diagnostics: means over all minibatches.

        pi is a Gaussian with mean mu(s) and standard deviation sigma. With z = (a - mu) / sigma, the gradient of L is

            dL / d log pi = -r A / n where r A is the minimum, else 0    (because dr / d log pi = r)
            d log pi / d mu = z / sigma
            d log pi / d log sigma = z^2 - 1
        """
        actor, backprop = self._actor, passes(self._actor.mean)
        log_ratios, objectives = [], []
        for observations, actions, log_probs, advantages in batch.split(
            batch.observations, batch.actions, batch.log_probs, batch.advantages
        ):
            inverse_std = torch.exp(-actor.log_std)
            z = (actions - backprop.forward(observations)) * inverse_std
            log_ratio = actor.log_density(z) - log_probs
            ratio = log_ratio.exp()
            unclipped, clipped = ratio * advantages, ratio.clamp(1.0 - self._clip, 1.0 + self._clip) * advantages
            # L = -mean(min(unclipped, clipped)). Where `clipped` is smaller, the ratio is outside and the slope is 0.
            # A comparison with NaN is false, so NaN stays in the gradient, and `step` raises an error.
            by_log_prob = torch.where(unclipped > clipped, 0.0, unclipped) / -len(advantages)
            backprop.backward(by_log_prob[:, None] * z * inverse_std)
            if actor.learns_std:
                gradient(actor.log_std).copy_(by_log_prob @ (z.square() - 1.0))
            self.step(f"batch {batch.number}")
            log_ratios.append(log_ratio)
            objectives.append(torch.minimum(unclipped, clipped))
        log_ratio = torch.cat(log_ratios)
        ratio = log_ratio.exp()
        return {
            "policy_loss": -torch.cat(objectives).mean().item(),
            "approx_kl": (ratio - 1.0 - log_ratio).mean().item(),  # Schulman 2020, the estimator k3
            "clip_fraction": ((ratio - 1.0).abs() > self._clip).float().mean().item(),
        }


class CriticLearner(Learner):
    """Learns the critic by least squares on the returns.

    With the critic's value V(s) of an observation s, its return R and c = `weight`, the loss is the value loss in eq. 9
    of Schulman et al. (2017) with its factor c_1 = c, averaged over the n transitions of a minibatch:

        L = c mean((V(s) - R)^2),    dL / dV = 2 c (V - R) / n
    """

    def __init__(self, critic: Critic, max_grad_norm: float, weight: float) -> None:
        super().__init__(critic, max_grad_norm)
        self._critic, self._weight = critic, weight

    @torch.no_grad()
    def learn(self, batch: Batch) -> dict[str, float]:
        """Makes one step per minibatch. Returns the mean squared error over all minibatches, without the factor c."""
        backprop = passes(self._critic.value)
        errors = []
        for observations, returns in batch.split(batch.observations, batch.returns):
            error = backprop.forward(observations)[:, 0] - returns
            backprop.backward((2.0 * self._weight / len(error) * error)[:, None])
            self.step(f"batch {batch.number}")
            errors.append(error)
        return {"value_loss": torch.cat(errors).square().mean().item()}


def learn(actor: ActorLearner, critic: CriticLearner, batch: Batch) -> dict[str, float]:
    """Trains actor and critic on a batch, in two threads. Returns the diagnostics of both."""
    with ThreadPoolExecutor(1) as pool:
        values = pool.submit(critic.learn, batch)
        return actor.learn(batch) | values.result()
