"""Curves of the De Groote-Fregly (2016) muscle, each with its derivative: smooth everywhere, for optimization.

They are dimensionless, like those of `thelen2003`. Source: De Groote, Kinney, Rao, Fregly, "Evaluation of direct
collocation optimal control problem formulations for solving the muscle redundancy problem", Annals of Biomedical
Engineering 44:2922-2936, 2016. The constants are those of OpenSim's DeGrooteFregly2016Muscle, which adjusts some of
them so that the curves pass through their key points. As published, the tendon curve is slightly negative for a slack
tendon: a slack tendon pushes with up to 0.2 times max_isometric_force.
"""

import math

from drakearm.muscle.compiled import inlined
from drakearm.muscle.elementary import CURVE_EXPONENT, exp

_GAUSSIANS = (
    (0.8150671134243542, 1.055033428970575, 0.162384573599574, 0.063303448465465),
    (0.433004984392647, 0.716775413397760, -0.029947116970696, 0.200356847296188),
    (0.1, 1.0, 0.353553390593274, 0.0),
)
_D1, _D2, _D3, _D4 = -0.3211346127989808, -8.149, -0.374, 0.8825327733249912  # of the force-velocity curve
_TENDON_SCALE = 0.2  # c1 and c3
_TENDON_RATE = math.log((1.0 + _TENDON_SCALE) / _TENDON_SCALE)  # to be divided by tendon_strain
_SHORTEST_PASSIVE = 0.2  # fiber length at which the passive force is 0
_LOWEST, _HIGHEST = -0.5, 2.3  # ratios of forces: beyond them the velocity, there about 5, continues along tangents


def passive_constants(passive_strain: float, passive_shape: float) -> tuple[float, float]:
    """Offset and scale of the passive force: scale * (exponential - offset)."""
    offset = math.exp(passive_shape / passive_strain * (_SHORTEST_PASSIVE - 1.0))
    return offset, 1.0 / (math.exp(passive_shape) - offset)


@inlined
def active_force_length(length, m):
    """Active isometric force and its slope at a normalized fiber length: a sum of three Gaussian-like curves."""
    force = slope = 0.0
    for height, center, width, widening in _GAUSSIANS:
        spread = width + widening * length
        z = (length - center) / spread
        term = height * exp(max(-0.5 * z * z, -CURVE_EXPONENT))
        force += term
        slope -= term * z * (1.0 - widening * z) / spread
    return force, slope


@inlined
def passive_force_length(length, m):
    """Passive force and its slope at a normalized fiber length: an exponential, 0 at _SHORTEST_PASSIVE."""
    rate = m.passive_shape / m.passive_strain
    growth = exp(min(rate * (length - 1.0), CURVE_EXPONENT))
    return (growth - m.passive_offset) * m.passive_scale, rate * growth * m.passive_scale


@inlined
def tendon_force_strain(strain, m):
    """Tendon force and its slope at a strain: an exponential through 0 at slack length and 1 at tendon_strain."""
    rate = _TENDON_RATE / m.tendon_strain
    growth = exp(min(max(rate * strain, -CURVE_EXPONENT), CURVE_EXPONENT))
    return _TENDON_SCALE * (growth - 1.0), _TENDON_SCALE * rate * growth


@inlined
def velocity_of_force(active, isometric, m):
    """Velocity at an active force, given the isometric one: a hyperbolic sine. See `thelen2003.velocity_of_force`."""
    inverse = 1.0 / isometric
    ratio = active * inverse
    at = min(max(ratio, _LOWEST), _HIGHEST)
    z = (at - _D4) / _D1
    up = 0.5 * exp(z)
    down = 0.25 / up
    slope = (up + down) / (_D1 * _D2)
    return (up - down - _D3) / _D2 + slope * (ratio - at), 1.0, slope * inverse, slope * ratio * inverse


@inlined
def force_of_velocity(velocity, m):
    """Active over isometric force at a velocity, and its slope: inverse of `velocity_of_force` without its tangents."""
    z = _D2 * velocity + _D3
    return _D1 * math.asinh(z) + _D4, _D1 * _D2 / math.sqrt(z * z + 1.0)


@inlined
def velocity_scale(activation, m):
    """Factor of the velocity at an activation, and its slope: 1 and 0, because this model does not have the factor."""
    return 1.0, 0.0
