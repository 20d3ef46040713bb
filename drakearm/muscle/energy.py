"""Power of a muscle: what fiber and tendon deliver, and what the muscle burns."""

import math

from drakearm.muscle.compiled import inner
from drakearm.muscle.models import active_force_length, passive_force_length

# W/kg; Bhargava, Pandy, Anderson, "A phenomenological model for estimating metabolic energy consumption in muscle
# contraction", Journal of Biomechanics 37:81-88, 2004.
_ACTIVATION_SLOW, _ACTIVATION_FAST = 40.0, 133.0
_MAINTENANCE_SLOW, _MAINTENANCE_FAST = 74.0, 111.0
_LEAST_HEAT = 1.0


@inner
def fiber_forces(fiber_length, tendon_force, m):
    """Active and passive force (N) along the fiber that together carry a tendon force."""
    cosine = math.sqrt(1.0 - (m.fiber_width / fiber_length) ** 2)
    passive, _ = passive_force_length(fiber_length / m.optimal_fiber_length, m)
    passive *= m.max_isometric_force
    return tendon_force / cosine - passive, passive


@inner
def fiber_and_tendon_power(fiber_length, fiber_velocity, mtu_velocity, tendon_force, m):
    """Power (W) that the fiber and that the tendon deliver; their sum is -tendon_force * mtu_velocity."""
    cosine = math.sqrt(1.0 - (m.fiber_width / fiber_length) ** 2)
    along = fiber_velocity / cosine  # velocity of the fiber's end along the tendon, whose width does not change
    return -tendon_force * along, -tendon_force * (mtu_velocity - along)


@inner
def metabolic_power(activation, excitation, fiber_length, fiber_velocity, active, passive, m):
    """Metabolic power (W) of a muscle: heat of activation, maintenance and shortening, and work (Bhargava et al. 2004).

    active, passive: forces along the fiber (N). As in OpenSim's probe, activation heat does not decay, lengthening does
    no work, and the heat does not fall below 1 W/kg. Basal power is left to the user.
    """
    u = min(max(excitation, 0.0), 1.0)
    slow, fast = m.slow_twitch_fraction, 1.0 - m.slow_twitch_fraction
    by_u_slow, by_u_fast = math.sin(0.5 * math.pi * u), 1.0 - math.cos(0.5 * math.pi * u)
    by_a_slow, by_a_fast = math.sin(0.5 * math.pi * activation), 1.0 - math.cos(0.5 * math.pi * activation)
    heat = m.mass * (_ACTIVATION_SLOW * slow * by_u_slow + _ACTIVATION_FAST * fast * by_u_fast)
    maintenance = _MAINTENANCE_SLOW * slow * by_a_slow + _MAINTENANCE_FAST * fast * by_a_fast
    length = fiber_length / m.optimal_fiber_length
    heat += m.mass * _maintenance_by_length(length) * maintenance
    work = 0.0
    if fiber_velocity <= 0.0:
        shape, _ = active_force_length(length, m)
        isometric = activation * shape * m.max_isometric_force
        heat -= (0.16 * isometric + 0.18 * (active + passive)) * fiber_velocity
        work = -active * fiber_velocity
    else:
        heat -= 0.157 * (active + passive) * fiber_velocity
    return max(heat, _LEAST_HEAT * m.mass) + work


@inner
def _maintenance_by_length(length):
    """How maintenance heat depends on the normalized fiber length: 0.5 to 0.5, 1 at 1, 0 from 1.5."""
    if length <= 0.5:
        return 0.5
    if length <= 1.0:
        return length
    return max(3.0 - 2.0 * length, 0.0)
