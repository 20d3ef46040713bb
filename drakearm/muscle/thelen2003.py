"""Curves of the Thelen (2003) muscle as OpenSim 4.6 implements it, each with its derivative.

All are dimensionless: forces over max_isometric_force, fiber lengths over optimal_fiber_length, velocities over
max_contraction_velocity. `m` is a record of `MUSCLE_DTYPE`. Equation numbers: Thelen, "Adjustment of muscle mechanics
model parameters to simulate dynamic contractions in older adults", J. Biomech. Eng. 125:70-77, 2003.
The curves clamp and select values instead of branching, so that one vector instruction can compute several lanes (see
`drakearm.muscle.compiled`).
"""

import math

from drakearm.muscle.compiled import fma, inlined
from drakearm.muscle.elementary import CURVE_EXPONENT, exp

TOE_SHAPE = 3.0  # exponent of the tendon's toe region
TOE_FORCE = 0.33  # tendon force where the toe region ends
TOE_SCALE = TOE_FORCE / (math.exp(TOE_SHAPE) - 1.0)
# The strain at which the toe region ends, over tendon_strain: the strain at max_isometric_force (eq. 5).
TOE_RATIO = 99.0 * math.exp(TOE_SHAPE) / (166.0 * math.exp(TOE_SHAPE) - 67.0)
TOE_RATE = TOE_SHAPE / TOE_RATIO
LINEAR_SLOPE = (1.0 - TOE_FORCE) / (1.0 - TOE_RATIO)  # slope of the tendon curve after the toe, times tendon_strain
LINEAR_FROM = 0.95  # times eccentric_force: above this force the force-velocity curve continues along its tangent


def passive_constants(passive_strain: float, passive_shape: float) -> tuple[float, float]:
    """Offset and scale of the passive force: scale * (exponential - offset) (eq. 3)."""
    return 1.0, 1.0 / math.expm1(passive_shape)


@inlined
def active_force_length(length, m):
    """Active isometric force and its slope at a normalized fiber length (eq. 4)."""
    per_width = 1.0 / m.active_width
    force = exp(max((1.0 - length) * (length - 1.0) * per_width, -CURVE_EXPONENT))
    return force, 2.0 * per_width * (1.0 - length) * force


@inlined
def passive_force_length(length, m):
    """Passive force and its slope at a normalized fiber length (eq. 3); both 0 below the optimal length."""
    rate = m.passive_shape / m.passive_strain
    growth = exp(min(rate * max(length - 1.0, 0.0), CURVE_EXPONENT))
    slope = rate * growth * m.passive_scale
    return (growth - m.passive_offset) * m.passive_scale, slope if length > 1.0 else 0.0


@inlined
def tendon_force_strain(strain, m):
    """Tendon force and its slope at a strain (eq. 5): exponential in the toe region, then linear; both 0 when slack."""
    toe_strain = TOE_RATIO * m.tendon_strain
    toe_rate, stiffness = TOE_RATE / m.tendon_strain, LINEAR_SLOPE / m.tendon_strain
    growth = exp(toe_rate * min(max(strain, 0.0), toe_strain))
    force = fma(stiffness, max(strain - toe_strain, 0.0), (growth - 1.0) * TOE_SCALE)
    slope = toe_rate * growth * TOE_SCALE
    taut_slope = stiffness if strain > toe_strain else slope
    return force, taut_slope if strain > 0.0 else 0.0


@inlined
def velocity_of_force(active, isometric, m):
    """Fiber velocity at an active force, given the isometric force > 0 (eq. 6); negative for a shortening fiber.

    Returns numerator and denominator of the velocity, and two slopes as numerators over the same denominator: that with
    respect to `active`, and minus that with respect to `isometric`. With fractions the caller often saves a division.
    The velocity is that at full activation; `velocity_scale` reduces it for other activations. For active forces below
    0 or above LINEAR_FROM * eccentric_force * isometric the curve continues along its tangents, so a velocity exists
    for every force.
    """
    highest = m.eccentric_force
    per_shape = 1.0 / m.force_velocity_shape
    steepness = 1.0 + per_shape
    scale = (highest - 1.0) / (2.0 * steepness)
    at = min(max(active, 0.0), LINEAR_FROM * highest * isometric)
    lengthens = at > isometric
    root = fma(highest, isometric, -at) if lengthens else fma(at, per_shape, isometric)
    slope = scale * (highest - 1.0) if lengthens else steepness
    excess = (scale if lengthens else 1.0) * (at - isometric) * root
    return fma(slope * isometric, active - at, excess), root * root, slope * isometric, slope * active


@inlined
def force_of_velocity(velocity, m):
    """Active over isometric force at a velocity, and its slope: inverse of `velocity_of_force`, but never below 0."""
    highest = m.eccentric_force
    steepness = 1.0 + 1.0 / m.force_velocity_shape
    scale = (highest - 1.0) / (2.0 * steepness)
    knee = LINEAR_FROM * highest
    at = min(max(velocity, -1.0), scale * (knee - 1.0) / (highest - knee))
    lengthens = at > 0.0
    inverse = 1.0 / ((at + scale) if lengthens else (1.0 - at / m.force_velocity_shape))
    slope = (scale * (highest - 1.0) if lengthens else steepness) * inverse * inverse
    force = ((at * highest + scale) if lengthens else (1.0 + at)) * inverse
    return force + (slope * (velocity - at) if lengthens else 0.0), slope if velocity > -1.0 else 0.0


@inlined
def velocity_scale(activation, m):
    """Factor of the velocity at an activation, and its slope (eq. 6): 0.25 at activation 0, 1 at full activation."""
    return fma(0.75, activation, 0.25), 0.75
