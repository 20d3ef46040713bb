"""Forces along the fiber, mechanical power of fiber and tendon, and the metabolic power of a muscle.

`m` is a record of `MUSCLE_DTYPE`. A fiber length below the minimum is replaced by the minimum, as in OpenSim.
"""

import math

from drakearm.muscle.compiled import inner
from drakearm.muscle.models import active_force_length, passive_force_length

# W/kg; Bhargava, Pandy, Anderson, "A phenomenological model for estimating metabolic energy consumption in muscle
# contraction", Journal of Biomechanics 37:81-88, 2004.
_ACTIVATION_SLOW, _ACTIVATION_FAST = 40.0, 133.0
_MAINTENANCE_SLOW, _MAINTENANCE_FAST = 74.0, 111.0
_MINIMUM_HEAT = 1.0


@inner
def fiber_forces(fiber_length, tendon_force, m):
    """Active and passive force (N) along the fiber. Together they balance a tendon force (N)."""
    passive, _ = passive_force_length(max(fiber_length, m.minimum_fiber_length) / m.optimal_fiber_length, m)
    passive *= m.max_isometric_force
    return tendon_force / _pennation_cosine(fiber_length, m) - passive, passive


@inner
def fiber_and_tendon_power(fiber_length, fiber_velocity, mtu_velocity, tendon_force, m):
    """Mechanical power (W) that the fiber and the tendon deliver. Their sum is -tendon_force * mtu_velocity."""
    along = fiber_velocity / _pennation_cosine(fiber_length, m)  # m/s along the tendon; the fiber's width is fixed
    return -tendon_force * along, -tendon_force * (mtu_velocity - along)


@inner
def metabolic_power(activation, excitation, fiber_length, fiber_velocity, active, passive, m):
    """Metabolic power (W) of a muscle: heat plus mechanical work, without the basal power of the body.

    active, passive: forces along the fiber (N); fiber_velocity (m/s) is positive when the fiber lengthens. The power is
    that of OpenSim's Bhargava2004MuscleMetabolicsProbe with use_force_dependent_shortening_prop_constant = true, as in
    the paper of Bhargava et al. (2004), and include_negative_mechanical_work = false. Its two limits apply: the total
    power is never negative, and the heat is at least 1 W per kg of muscle. The probe does not limit the excitation;
    here it is clamped to [0, 1].
    """
    activating, maintaining, shortening, work = metabolic_rates(
        activation, excitation, fiber_length, fiber_velocity, active, passive, m
    )
    heat = activating + maintaining + shortening
    return max(heat, -work, _MINIMUM_HEAT * m.mass) + work


@inner
def metabolic_rates(activation, excitation, fiber_length, fiber_velocity, active, passive, m):
    """The four parts (W) of the metabolic power before its limits apply, for the same arguments.

    They are the heat of activation, of maintenance and of shortening, and the mechanical work. As in OpenSim, the heat
    of activation does not decay in time, as it does in Bhargava et al. (2004). For a lengthening fiber the heat of
    shortening is negative and the work is 0.
    """
    length = max(fiber_length, m.minimum_fiber_length) / m.optimal_fiber_length
    u = min(max(excitation, 0.0), 1.0)
    slow = m.slow_twitch_fraction * math.sin(0.5 * math.pi * u)
    fast = (1.0 - m.slow_twitch_fraction) * (1.0 - math.cos(0.5 * math.pi * u))
    activating = m.mass * (_ACTIVATION_SLOW * slow + _ACTIVATION_FAST * fast)
    maintaining = m.mass * _maintenance_by_length(length) * (_MAINTENANCE_SLOW * slow + _MAINTENANCE_FAST * fast)
    if fiber_velocity > 0.0:
        return activating, maintaining, -0.157 * (active + passive) * fiber_velocity, 0.0
    a = min(max(activation, m.minimum_activation), 1.0)
    shape, _ = active_force_length(length, m)
    isometric = a * shape * m.max_isometric_force
    shortening = -(0.16 * isometric + 0.18 * (active + passive)) * fiber_velocity
    return activating, maintaining, shortening, -active * fiber_velocity


@inner
def _maintenance_by_length(length):
    """Factor of the maintenance heat at a normalized fiber length: linear between 0.5 at 0.5, 1 at 1 and 0 at 1.5.

    It is constant outside [0.5, 1.5], as in OpenSim.
    """
    if length <= 0.5:
        return 0.5
    if length <= 1.0:
        return length
    return max(3.0 - 2.0 * length, 0.0)


@inner
def _pennation_cosine(fiber_length, m):
    return math.sqrt(1.0 - (m.fiber_width / max(fiber_length, m.minimum_fiber_length)) ** 2)
