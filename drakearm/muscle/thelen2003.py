"""Curves of the Thelen (2003) muscle as OpenSim 4.6 implements it, each with its derivative.

All are dimensionless: forces over max_isometric_force, fiber lengths over optimal_fiber_length, velocities over
max_contraction_velocity. `m` is a record of `MUSCLE_DTYPE`. Equation numbers: Thelen, "Adjustment of muscle mechanics
model parameters to simulate dynamic contractions in older adults", J. Biomech. Eng. 125:70-77, 2003.
"""

import math

from drakearm.muscle.compiled import compiled

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


@compiled
def active_force_length(length, m):
    """Active isometric force and its slope at a normalized fiber length (eq. 4)."""
    force = math.exp(-((length - 1.0) ** 2) / m.active_width)
    return force, -2.0 * (length - 1.0) / m.active_width * force


@compiled
def passive_force_length(length, m):
    """Passive force and its slope at a normalized fiber length (eq. 3), 0 below the optimal length."""
    if length <= 1.0:
        return 0.0, 0.0
    rate = m.passive_shape / m.passive_strain
    scale = 1.0 / (math.exp(m.passive_shape) - 1.0)
    growth = math.exp(rate * (length - 1.0))
    return (growth - 1.0) * scale, rate * growth * scale


@compiled
def tendon_force_strain(strain, m):
    """Tendon force and its slope at a strain (eq. 5): exponential toe, then linear; 0 when slack."""
    if strain <= 0.0:
        return 0.0, 0.0
    if strain > m.toe_strain:
        return m.tendon_stiffness * (strain - m.toe_strain) + TOE_FORCE, m.tendon_stiffness
    growth = math.exp(TOE_SHAPE * strain / m.toe_strain)
    return (growth - 1.0) * TOE_SCALE, TOE_SHAPE / m.toe_strain * growth * TOE_SCALE


@compiled
def velocity_of_force(ratio, m):
    """Shortening (< 0) or lengthening velocity at a ratio of active force to isometric force, and its slope (eq. 6).

    The velocity is that of full activation; `velocity_scale` shrinks it with activation. Below 0 and beyond
    LINEAR_FROM * eccentric_force it continues along the tangents, so that it exists for every force.
    """
    curvature = m.force_velocity_shape
    highest = m.eccentric_force
    if ratio <= 0.0:
        slope = 1.0 + 1.0 / curvature
        return slope * ratio - 1.0, slope
    if ratio <= 1.0:
        denominator = 1.0 + ratio / curvature
        return (ratio - 1.0) / denominator, (1.0 + 1.0 / curvature) / denominator**2
    scale = (highest - 1.0) / (2.0 + 2.0 / curvature)
    knee = LINEAR_FROM * highest
    at = min(ratio, knee)
    denominator = highest - at
    slope = scale * (highest - 1.0) / denominator**2
    return scale * (at - 1.0) / denominator + slope * (ratio - at), slope


@compiled
def force_of_velocity(velocity, m):
    """Active over isometric force at a velocity, and its slope: inverts `velocity_of_force`, but is never below 0."""
    curvature = m.force_velocity_shape
    highest = m.eccentric_force
    if velocity <= -1.0:
        return 0.0, 0.0
    if velocity <= 0.0:
        denominator = 1.0 - velocity / curvature
        return (1.0 + velocity) / denominator, (1.0 + 1.0 / curvature) / denominator**2
    scale = (highest - 1.0) / (2.0 + 2.0 / curvature)
    knee = LINEAR_FROM * highest
    at = min(velocity, scale * (knee - 1.0) / (highest - knee))
    slope = scale * (highest - 1.0) / (at + scale) ** 2
    return (at * highest + scale) / (at + scale) + slope * (velocity - at), slope


@compiled
def velocity_scale(activation):
    """Factor of the velocity at an activation, and its slope (eq. 6): a quarter at rest, 1 at full activation."""
    return 0.25 + 0.75 * activation, 0.75
