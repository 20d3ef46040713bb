"""Scaling of a network's inputs: how observations are standardized during a training."""

from dataclasses import dataclass

import numpy as np

_LEAST_DEVIATION = 0.02  # of an observation, which is near 1: smaller variations are not stretched further


@dataclass(frozen=True)
class InputScaling:
    """Standardizes observations: minus their mean, divided by their standard deviation. Arrays (n_obs,), float32.

    A network learns faster from numbers that all vary by about 1 (LeCun et al. 1998, "Efficient backprop", section
    4.3). But the fiber lengths of a movement vary by a few percent only. After the training, `folded` puts the
    scaling into the network, which then takes observations as they are.
    """

    mean: np.ndarray
    scale: np.ndarray

    @classmethod
    def of(cls, observations: np.ndarray) -> "InputScaling":
        """The scaling that standardizes these observations (n, n_obs)."""
        samples = observations.astype(np.float64)
        scale = 1.0 / (samples.std(axis=0) + _LEAST_DEVIATION)
        return cls(samples.mean(axis=0).astype(np.float32), scale.astype(np.float32))

    @classmethod
    def none(cls, n_observations: int) -> "InputScaling":
        """The scaling that changes nothing."""
        return cls(np.zeros(n_observations, np.float32), np.ones(n_observations, np.float32))

    def __call__(self, observations: np.ndarray) -> np.ndarray:
        """The standardized observations (..., n_obs)."""
        return (observations - self.mean) * self.scale

    def folded(self, weight: np.ndarray, bias: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weight (n, n_obs) and bias (n,) of a first layer that takes observations that are not standardized."""
        unscaled = weight.astype(np.float64) * self.scale
        shifted = bias - (unscaled * self.mean).sum(axis=1)
        return unscaled.astype(np.float32), shifted.astype(np.float32)

    def unfolded(self, weight: np.ndarray, bias: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The opposite of `folded`: weight and bias of a first layer that takes standardized observations."""
        shifted = bias + (weight.astype(np.float64) * self.mean).sum(axis=1)
        return (weight.astype(np.float64) / self.scale).astype(np.float32), shifted.astype(np.float32)
