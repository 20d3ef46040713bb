"""The torque of joint stops, which keep joints in their range, as compiled functions; and how strong the stops are."""

import numpy as np

from drakearm.model.arm import Arm
from drakearm.model.skeleton import neutral_posture, skeleton_plant
from drakearm.muscle.compiled import compiled, inner

STOP_STIFFNESS = 5000.0  # Nm/rad, default
STOP_DAMPING = 10.0  # Nm s/rad, default
# The most that is stable in time steps of 1 ms, with a margin for the coupling of the joints and for the hardening.
# Per moment of inertia about the joint, kg m^2:
_STIFFEST = 2e5  # 1/s^2
_MOST_DAMPED = 250.0  # 1/s
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


def stop_strength(arm: Arm) -> tuple[np.ndarray, np.ndarray]:
    """The stiffness (n_q,), Nm/rad, and the damping (n_q,), Nm s/rad, of the stops of an arm.

    They are the default ones, but less in a limb that is so light that these would throw it back ever faster. The limb
    counts without a load, in its neutral posture.
    """
    plant = skeleton_plant(arm)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, neutral_posture(plant))
    inertia = np.diag(plant.CalcMassMatrix(context))
    return np.minimum(STOP_STIFFNESS, _STIFFEST * inertia), np.minimum(STOP_DAMPING, _MOST_DAMPED * inertia)


@compiled
def stop_torque(q, v, lower, upper, stiffness, damping):
    """`joint_stop_torque` of every joint. All arguments and the result: (n_q,)."""
    tau = np.empty(len(q))
    for i in range(len(q)):
        tau[i] = joint_stop_torque(q[i], v[i], lower[i], upper[i], stiffness[i], damping[i])
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
        tau[i] = joint_stop_torque(q, v, lower[i], upper[i], stiffness[i], damping[i])
