"""Activation dynamics: how the activation of a muscle follows its excitation."""

from drakearm.muscle.compiled import fma, inlined


@inlined
def activation_rate(activation, excitation, m):
    """Rate of the activation (1/s), and the derivatives of this rate with respect to activation and excitation.

    The dynamics are of first order, and faster when the activation rises than when it falls (Thelen 2003, eqs. 1-2, as
    in OpenSim's Thelen2003Muscle). The excitation is clamped to [minimum_activation, 1], so the activation never leaves
    that interval. OpenSim does not clamp the excitation: at excitation 0 its activation falls below the minimum.
    """
    u = min(max(excitation, m.minimum_activation), 1.0)
    free = 1.0 if u == excitation else 0.0
    speed = fma(1.5, activation, 0.5)
    rises = u > activation
    per_deactivation_time = 1.0 / m.deactivation_time  # the same in all lanes: a loop over lanes divides only once
    rate = 1.0 / (m.activation_time * speed) if rises else speed * per_deactivation_time
    bend = (-1.5 if rises else 1.5) * (u - activation) * rate / speed
    return (u - activation) * rate, bend - rate, rate * free


@inlined
def activation_step(activation, excitation, time_step, m):
    """Activation one time step (s) later, under a constant excitation: explicit midpoint rule, of second order."""
    rate, _, _ = activation_rate(activation, excitation, m)
    middle = fma(0.5 * time_step, rate, activation)
    rate, _, _ = activation_rate(middle, excitation, m)
    return min(max(fma(time_step, rate, activation), m.minimum_activation), 1.0)
