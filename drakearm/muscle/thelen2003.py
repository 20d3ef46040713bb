"""Curves of the Thelen (2003) muscle as OpenSim 4.6 implements it, each with its derivative.

All are dimensionless: forces over max_isometric_force, fiber lengths over optimal_fiber_length, velocities over
max_contraction_velocity. `m` is a record of `MUSCLE_DTYPE`. Equation numbers: Thelen, "Adjustment of muscle mechanics
model parameters to simulate dynamic contractions in older adults", J. Biomech. Eng. 125:70-77, 2003.
They clamp and choose instead of branching, so that many muscles can be evaluated at once.
"""

import math

from drakearm.muscle.compiled import inlined
from drakearm.muscle.elementary import GREATEST_EXPONENT, LEAST_EXPONENT, exp

TOE_SHAPE = 3.0  # exponent of the tendon's toe region
TOE_FORCE = 0.33  # tendon force where the toe region ends
TOE_SCALE = TOE_FORCE / (math.exp(TOE_SHAPE) - 1.0)
LINEAR_FROM = 0.95  # share of eccentric_force beyond which force-velocity continues along its tangent


def toe_strain(tendon_strain: float) -> float:
    """Strain where the toe region of a tendon ends that bears max_isometric_force at `tendon_strain` (eq. 5)."""
    e3 = math.exp(TOE_SHAPE)
    return 99.0 * tendon_strain * e3 / (166.0 * e3 - 67.0)


def tendon_stiffness(tendon_strain: float) -> float:
    """Slope of the tendon curve beyond its toe region (eq. 5)."""
    return (1.0 - TOE_FORCE) / (tendon_strain - toe_strain(tendon_strain))


def passive_constants(passive_strain: float, passive_shape: float) -> tuple[float, float]:
    """Offset and scale of the passive force's exponential (eq. 3)."""
    return 1.0, 1.0 / math.expm1(passive_shape)


@inlined
def active_force_length(length, m):
    """Active isometric force and its slope at a normalized fiber length (eq. 4)."""
    force = exp(max((1.0 - length) * (length - 1.0) / m.active_width, LEAST_EXPONENT))
    return force, 2.0 / m.active_width * (1.0 - length) * force


@inlined
def passive_force_length(length, m):
    """Passive force and its slope at a normalized fiber length (eq. 3), 0 below the optimal length."""
    rate = m.passive_shape / m.passive_strain
    growth = exp(min(rate * max(length - 1.0, 0.0), GREATEST_EXPONENT))
    slope = rate * growth * m.passive_scale
    return (growth - m.passive_offset) * m.passive_scale, slope if length > 1.0 else 0.0


@inlined
def tendon_force_strain(strain, m):
    """Tendon force and its slope at a strain (eq. 5): exponential toe, then linear; 0 when slack."""
    growth = exp(TOE_SHAPE / m.toe_strain * min(max(strain, 0.0), m.toe_strain))
    force = (growth - 1.0) * TOE_SCALE + m.tendon_stiffness * max(strain - m.toe_strain, 0.0)
    slope = TOE_SHAPE / m.toe_strain * growth * TOE_SCALE
    taut_slope = m.tendon_stiffness if strain > m.toe_strain else slope
    return force, taut_slope if strain > 0.0 else 0.0


@inlined
def velocity_of_force(active, isometric, m):
    """Shortening (< 0) or lengthening velocity where `active` force meets `isometric` force > 0 (eq. 6).

    Returns numerator and denominator of the velocity, and over the same denominator its slope by the active force and
    minus that by the isometric force: whoever goes on computing with them may need one division less. The velocity is
    that of full activation; `velocity_scale` shrinks it with activation. Below 0 and beyond LINEAR_FROM *
    eccentric_force * isometric it continues along the tangents, so that it exists for every force.
    """
    highest = m.eccentric_force
    steepness = 1.0 + 1.0 / m.force_velocity_shape
    scale = (highest - 1.0) / (2.0 * steepness)
    at = min(max(active, 0.0), LINEAR_FROM * highest * isometric)
    lengthens = at > isometric
    root = (highest * isometric - at) if lengthens else (isometric + at / m.force_velocity_shape)
    slope = scale * (highest - 1.0) if lengthens else steepness
    excess = (scale if lengthens else 1.0) * (at - isometric) * root
    return excess + slope * isometric * (active - at), root * root, slope * isometric, slope * active


@inlined
def force_of_velocity(velocity, m):
    """Active over isometric force at a velocity, and its slope: inverts `velocity_of_force`, but is never below 0."""
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
def velocity_scale(activation):
    """Factor of the velocity at an activation, and its slope (eq. 6): a quarter at rest, 1 at full activation."""
    return 0.25 + 0.75 * activation, 0.75
