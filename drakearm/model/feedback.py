"""Feedback on the tracking error: it gives the accelerations that static optimization tries to exert."""

from typing import NamedTuple

import numpy as np


class Feedback(NamedTuple):
    """Adds feedback of the tracking error to the reference's accelerations (Thelen, Anderson and Delp 2003, eq. 1)."""

    stiffness: float  # 1/s^2, of the position error
    damping: float  # 1/s, of the speed error

    def acceleration(self, q: np.ndarray, v: np.ndarray, reference: np.ndarray) -> np.ndarray:
        """Desired accelerations (..., n_q), rad/s^2, at angles q and speeds v, (..., n_q).

        reference: desired q, v and a, (..., 3 n_q).
        """
        n_q = q.shape[-1]
        desired_q, desired_v, a = (reference[..., k * n_q : (k + 1) * n_q] for k in range(3))
        return a + self.stiffness * (desired_q - q) + self.damping * (desired_v - v)
