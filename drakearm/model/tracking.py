"""The reward for following a reference: every environment shares it."""

from typing import Any

import numpy as np


def tracking_reward(arm_state: np.ndarray, acceleration: np.ndarray, reference: np.ndarray, weights: np.ndarray) -> Any:
    """Minus the weighted squares of position errors, velocity errors and accelerations (eq. 6).

    arm_state, reference: q and v, (2 n_q,). acceleration: (n_q,). weights: of positions, velocities and accelerations,
    (3 n_q,). For the rewards (N,) of many arms there is a row for each in all of them.
    """
    lost = np.concatenate([reference - arm_state, acceleration], axis=-1)
    return -(weights * lost**2).sum(axis=-1)
