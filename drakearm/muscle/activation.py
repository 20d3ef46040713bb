"""Activation dynamics: how the activation of a muscle follows its excitation."""

from drakearm.muscle.compiled import inlined


@inlined
def activation_rate(activation, excitation, m):
    """Time derivative of the activation (1/s), and the derivatives of this rate by activation and by excitation.

    First order, and faster when the activation rises than when it falls (Thelen 2003, eqs. 1-2, as in OpenSim's
    Thelen2003Muscle). The excitation is clamped to [minimum_activation, 1], so that the activation never leaves that
    interval. OpenSim does not clamp it: at excitation 0 the activation falls below the minimum there.
    """
    u = min(max(excitation, m.minimum_activation), 1.0)
    free = 1.0 if u == excitation else 0.0
    speed = 0.5 + 1.5 * activation
    rises = u > activation
    rate = 1.0 / (m.activation_time * speed) if rises else speed / m.deactivation_time
    bend = (-1.5 if rises else 1.5) * (u - activation) * rate / speed
    return (u - activation) * rate, bend - rate, rate * free


@inlined
def activation_step(activation, excitation, time_step, m):
    """Activation one time step later, with a constant excitation: explicit midpoint rule, of second order."""
    rate, _, _ = activation_rate(activation, excitation, m)
    middle = activation + 0.5 * time_step * rate
    rate, _, _ = activation_rate(middle, excitation, m)
    return min(max(activation + time_step * rate, m.minimum_activation), 1.0)
