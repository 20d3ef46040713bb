"""The reward for following a reference: every environment shares it."""

from typing import Any

import numpy as np


def tracking_reward(
    q: np.ndarray,
    v: np.ndarray,
    a: np.ndarray,
    reference_q: np.ndarray,
    reference_v: np.ndarray,
    w_q: np.ndarray,
    w_v: np.ndarray,
    w_a: np.ndarray,
) -> Any:
    """Minus the weighted squares of position errors, velocity errors and accelerations (eq. 6).

    All arrays are (n_q,), or (N, n_q) for the rewards (N,) of many arms.
    """
    return -(w_q * (reference_q - q) ** 2 + w_v * (reference_v - v) ** 2 + w_a * a**2).sum(axis=-1)
