"""The torque of joint stops, compiled: every simulation of the arm shares it."""

import numpy as np

from drakearm.muscle.compiled import compiled, inner

STOP_STIFFNESS = 5000.0  # Nm/rad, unless a user chooses otherwise
STOP_DAMPING = 10.0  # Nm s/rad
SOFTENING = 0.02  # rad, penetration over which the damper comes in
HARDENING = 0.15  # rad, penetration at which the spring pulls twice as hard as a linear one


@inner
def joint_stop_torque(q, v, lower, upper, stiffness, damping):
    """Torque (Nm) that pushes a joint at angle q and speed v back into [lower, upper].

    Beyond a limit by d, a hardening spring and a damper resist: max(stiffness d (1 + (d / HARDENING)^2) + damping
    min(d / SOFTENING, 1) outward speed, 0). Stiff enough for a light arm, the spring would give way under a heavy load
    if it did not harden. Inside the range the torque is 0. A stop never pulls outward, and never returns more energy
    than its spring has taken up. It also runs uncompiled (py_func), with AutoDiffXd.
    """
    if lower <= q <= upper:
        return 0.0
    side = 1.0 if q > upper else -1.0
    depth = (q - upper) if q > upper else (lower - q)
    spring = stiffness * depth * (1.0 + (depth / HARDENING) ** 2)
    return -side * max(spring + damping * min(depth / SOFTENING, 1.0) * side * v, 0.0)


@compiled
def stop_torque(q, v, lower, upper, stiffness, damping):
    """`joint_stop_torque` of every joint; all arrays (n_q,)."""
    tau = np.empty(len(q))
    for i in range(len(q)):
        tau[i] = joint_stop_torque(q[i], v[i], lower[i], upper[i], stiffness, damping)
    return tau


@compiled
def held_stop_torque(tau, arm_state, time_step, lower, upper, stiffness, damping):
    """Writes the torques (n_q,) to hold for a time step: those of the joint state expected at its middle."""
    n_q = len(tau)
    for i in range(n_q):
        v = arm_state[n_q + i]
        q = arm_state[i] + 0.5 * time_step * v
        tau[i] = joint_stop_torque(q, v, lower[i], upper[i], stiffness, damping)
