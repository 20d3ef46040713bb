"""The torque of joint stops, which keep joints in their range, as compiled functions."""

import numpy as np

from drakearm.muscle.compiled import compiled, inner

STOP_STIFFNESS = 5000.0  # Nm/rad, default
STOP_DAMPING = 10.0  # Nm s/rad, default
SOFTENING = 0.02  # rad, penetration from which on the damper acts fully
HARDENING = 0.15  # rad, penetration at which the torque of the spring is twice that of a linear spring


@inner
def joint_stop_torque(q, v, lower, upper, stiffness, damping):
    """Torque (Nm) that pushes a joint at angle q and speed v back into [lower, upper].

    At a distance d beyond a limit, a hardening spring and a damper resist: max(stiffness d (1 + (d / HARDENING)^2) +
    damping min(d / SOFTENING, 1) outward speed, 0). Without hardening, a spring that is stiff enough for a light arm
    would yield too far under a heavy load. Inside the range the torque is 0. A stop never pulls outward, and never
    returns more energy than its spring has stored. The uncompiled function (py_func) also takes AutoDiffXd.
    """
    if lower <= q <= upper:
        return 0.0
    side = 1.0 if q > upper else -1.0
    depth = (q - upper) if q > upper else (lower - q)
    spring = stiffness * depth * (1.0 + (depth / HARDENING) ** 2)
    return -side * max(spring + damping * min(depth / SOFTENING, 1.0) * side * v, 0.0)


@compiled
def stop_torque(q, v, lower, upper, stiffness, damping):
    """`joint_stop_torque` of every joint. q, v, lower, upper and the result: (n_q,)."""
    tau = np.empty(len(q))
    for i in range(len(q)):
        tau[i] = joint_stop_torque(q[i], v[i], lower[i], upper[i], stiffness, damping)
    return tau


@compiled
def held_stop_torque(tau, arm_state, time_step, lower, upper, stiffness, damping):
    """Writes into tau (n_q,) the torques to hold during a time step: those at the joint state expected at its middle.

    arm_state: q and v, (2 n_q,), at the start of the step.
    """
    n_q = len(tau)
    for i in range(n_q):
        v = arm_state[n_q + i]
        q = arm_state[i] + 0.5 * time_step * v
        tau[i] = joint_stop_torque(q, v, lower[i], upper[i], stiffness, damping)
