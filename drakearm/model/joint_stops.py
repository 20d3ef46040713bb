"""The torque of joint stops, compiled: every simulation of the arm shares it."""

import numpy as np
from numba import njit

SOFTENING = 0.02  # rad, penetration over which the damper comes in


@njit(cache=True, error_model="numpy")
def one_stop_torque(q, v, lower, upper, stiffness, damping):
    """Torque (Nm) that pushes a joint at angle q and speed v back into [lower, upper].

    Beyond a limit by d, a spring and a damper resist: max(stiffness d + damping min(d / SOFTENING, 1) outward speed, 0).
    Inside the range the torque is 0. A stop never pulls outward, and never returns more energy than its spring took.
    Also runs uncompiled (py_func), with AutoDiffXd.
    """
    if q > upper:
        depth = q - upper
        return -max(stiffness * depth + damping * min(depth / SOFTENING, 1.0) * v, 0.0)
    if q < lower:
        depth = lower - q
        return max(stiffness * depth - damping * min(depth / SOFTENING, 1.0) * v, 0.0)
    return 0.0


@njit(cache=True, error_model="numpy")
def stop_torque(q, v, lower, upper, stiffness, damping):
    """`one_stop_torque` of every joint; all arrays (n_q,)."""
    tau = np.empty(len(q))
    for i in range(len(q)):
        tau[i] = one_stop_torque(q[i], v[i], lower[i], upper[i], stiffness, damping)
    return tau
