"""The torque of joint stops, compiled: every simulation of the arm shares it."""

import numpy as np
from numba import njit

SOFTENING = 0.02  # rad, penetration over which the damper comes in


@njit(cache=True, error_model="numpy")
def stop_torque(q, v, lower, upper, stiffness, damping):
    """Torques (n_q,) in Nm that push joints at angles q and speeds v back into [lower, upper].

    Beyond a limit by d, a spring and a damper resist: max(stiffness * d + damping * min(d / SOFTENING, 1) * speed
    outward, 0). Inside the range the torque is 0. A stop never pulls outward, and never returns more energy than its
    spring took.
    """
    tau = np.zeros(len(q))
    for i in range(len(q)):
        if q[i] > upper[i]:
            depth = q[i] - upper[i]
            resist = stiffness * depth + damping * min(depth / SOFTENING, 1.0) * v[i]
            tau[i] = -max(resist, 0.0)
        elif q[i] < lower[i]:
            depth = lower[i] - q[i]
            resist = stiffness * depth - damping * min(depth / SOFTENING, 1.0) * v[i]
            tau[i] = max(resist, 0.0)
    return tau
