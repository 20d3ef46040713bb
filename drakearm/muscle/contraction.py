"""Contraction dynamics: forces of tendons, velocities of fibers, a fiber's steps in time and its equilibrium.

`m` is a record of `MUSCLE_DTYPE`. The pennated fiber keeps its width, so its length along the tendon is
sqrt(l^2 - width^2). Fibers below their minimum length count as that long, as in OpenSim.
"""

import math

from drakearm.muscle.compiled import fma, inlined, inner
from drakearm.muscle.models import (
    active_force_length,
    force_of_velocity,
    passive_force_length,
    tendon_force_strain,
    velocity_of_force,
    velocity_scale,
)

_THIRD = 1.0 / 3.0
SHORTEST = 0.01  # of the optimal fiber length: floor for unpennated fibers, which have no minimum of their own
ITERATIONS = 100
QUICK_ITERATIONS = 6
TOLERANCE = 1e-8  # of the optimal fiber length, on the last of Newton's moves: what remains is its square


@inlined
def shortest_fiber(m):
    """The length (m) below which no fiber gets."""
    return max(m.minimum_fiber_length, SHORTEST * m.optimal_fiber_length)


@inlined
def tendon_force(fiber_length, mtu_length, m):
    """Force (N) of a compliant tendon and its derivatives by fiber and musculotendon length (N/m)."""
    fiber_length = max(fiber_length, m.minimum_fiber_length)
    along = math.sqrt(fma(fiber_length, fiber_length, -m.fiber_width * m.fiber_width))
    per_slack_length = 1.0 / m.tendon_slack_length  # the same in all lanes, so a loop divides only once
    force, slope = tendon_force_strain(fma(mtu_length - along, per_slack_length, -1.0), m)
    by_mtu = slope * per_slack_length * m.max_isometric_force
    return force * m.max_isometric_force, -by_mtu * fiber_length / along, by_mtu


@inlined
def rigid_fiber(mtu_length, mtu_velocity, m):
    """Length and velocity of a fiber on a rigid tendon, and the cosine of its pennation angle."""
    along = max(mtu_length - m.tendon_slack_length, 0.0)
    fiber_length = math.sqrt(along**2 + m.fiber_width**2)
    shortest = shortest_fiber(m)
    if fiber_length <= shortest:
        return shortest, 0.0, math.sqrt(1.0 - (m.fiber_width / shortest) ** 2)
    cosine = along / fiber_length
    return fiber_length, mtu_velocity * cosine, cosine


@inlined
def rigid_tendon_force(activation, mtu_length, mtu_velocity, m):
    """Force (N) that a fiber puts on its rigid tendon; derivatives by activation, musculotendon length and velocity."""
    a = min(max(activation, m.minimum_activation), 1.0)
    fiber_length, velocity, cosine = rigid_fiber(mtu_length, mtu_velocity, m)
    length = fiber_length / m.optimal_fiber_length
    shape, shape_slope = active_force_length(length, m)
    passive, passive_slope = passive_force_length(length, m)
    scale, scale_slope = velocity_scale(a, m)
    unit = m.max_contraction_velocity * m.optimal_fiber_length * scale
    factor, factor_slope = force_of_velocity(velocity / unit, m)
    force = a * shape * factor + passive
    by_activation = shape * (factor - a * factor_slope * velocity / unit * scale_slope / scale)
    by_length = by_velocity = 0.0
    if fiber_length > shortest_fiber(m):
        cosine_slope = m.fiber_width**2 / fiber_length**3
        by_velocity = a * shape * factor_slope * cosine**2 / unit
        by_length = force * cosine_slope + cosine * (
            (a * shape_slope * factor + passive_slope) * cosine / m.optimal_fiber_length
            + a * shape * factor_slope * mtu_velocity * cosine_slope / unit
        )
    f_max = m.max_isometric_force
    return f_max * force * cosine, f_max * by_activation * cosine, f_max * by_length, f_max * by_velocity


@inlined
def _velocity_fraction(activation, fiber_length, mtu_length, m):
    """The fiber velocity as a fraction: unit (m/s), numerator, denominator, and over the same its three derivatives.

    The derivatives are by activation, minus by fiber length, and by musculotendon length.
    """
    at_minimum = fiber_length <= m.minimum_fiber_length
    fiber_length = max(fiber_length, m.minimum_fiber_length)
    a = min(max(activation, m.minimum_activation), 1.0)
    free = 1.0 if a == activation else 0.0
    # The same in all lanes, so a loop divides only once.
    per_optimal_length, per_slack_length = 1.0 / m.optimal_fiber_length, 1.0 / m.tendon_slack_length
    along = math.sqrt(fma(fiber_length, fiber_length, -m.fiber_width * m.fiber_width))
    inverse_along = 1.0 / along
    secant = fiber_length * inverse_along
    length = fiber_length * per_optimal_length
    strain = fma(mtu_length - along, per_slack_length, -1.0)

    tendon, tendon_slope = tendon_force_strain(strain, m)
    passive, passive_slope = passive_force_length(length, m)
    shape, shape_slope = active_force_length(length, m)
    numerator, denominator, by_active, by_isometric = velocity_of_force(fma(tendon, secant, -passive), a * shape, m)
    scale, scale_slope = velocity_scale(a, m)

    held = at_minimum and numerator <= 0.0
    unit = (0.0 if held else m.max_contraction_velocity * m.optimal_fiber_length) * scale
    by_strain = tendon_slope * per_slack_length
    # How much less tendon force acts along the fiber per meter of fiber length.
    loss = fma(by_strain, secant * secant, tendon * (m.fiber_width * m.fiber_width) * inverse_along**3)
    by_length = by_active * fma(passive_slope, per_optimal_length, loss)
    by_length = fma(by_isometric, a * shape_slope * per_optimal_length, by_length)
    by_activation = free * (numerator * scale_slope / scale - by_isometric * shape)
    return unit, numerator, denominator, by_activation, by_length, by_active * by_strain * secant


@inlined
def fiber_velocity(activation, fiber_length, mtu_length, m):
    """Fiber velocity (m/s) and its derivatives by activation, fiber length and musculotendon length.

    The velocity at which the contractile element carries what the tendon pulls and the passive element does not
    (Thelen 2003, eq. 6). At the minimum fiber length a fiber can only lengthen.
    """
    unit, numerator, denominator, by_activation, by_length, by_mtu_length = _velocity_fraction(
        activation, fiber_length, mtu_length, m
    )
    unit /= denominator
    return unit * numerator, unit * by_activation, -unit * by_length, unit * by_mtu_length


@inlined
def slack_fiber_length(mtu_length, m):
    """Fiber length at which the tendon just goes slack."""
    return math.sqrt(max(mtu_length - m.tendon_slack_length, 0.0) ** 2 + m.fiber_width**2)


@inlined
def newton_move(x, weight, base, activation, mtu_length, m):
    """What `solve_fiber` finds at a fiber length x: its equation's residual, and Newton's move to the root.

    The residual comes multiplied by the denominator of the velocity, which spares a division.
    """
    unit, numerator, denominator, _, by_length, _ = _velocity_fraction(activation, x, mtu_length, m)
    residual = fma(unit, numerator, -weight * (x - base) * denominator)
    return residual, residual / fma(weight, denominator, unit * by_length)


@inner
def solve_fiber(weight, base, activation, mtu_length, guess, m):
    """Fiber length x with weight * (x - base) = fiber_velocity(x), or the shortest one where that is above the root.

    The left side rises and the right side falls with x, so the root lies below the base or the length at which the
    tendon goes slack. Newton's method stays inside the bracket that it narrows, or falls back to bisection.
    """
    low = shortest_fiber(m)
    high = max(max(base, slack_fiber_length(mtu_length, m)), low) * (1.0 + 1e-9)
    x = min(max(guess, low), high)
    for _ in range(ITERATIONS):
        residual, move = newton_move(x, weight, base, activation, mtu_length, m)
        if residual > 0.0:
            low = x
        else:
            high = x
        if not (low <= x + move <= high):
            move = 0.5 * (low + high) - x
        x += move
        if abs(move) < TOLERANCE * m.optimal_fiber_length:
            break
    return x


@inner
def equilibrium_fiber_length(activation, mtu_length, m):
    """Fiber length (m) at which a resting fiber and its tendon pull alike; NaN if none is short enough."""
    if m.rigid_tendon:
        fiber_length, _, _ = rigid_fiber(mtu_length, 0.0, m)
        return fiber_length if fiber_length > shortest_fiber(m) else math.nan
    velocity, _, _, _ = fiber_velocity(activation, shortest_fiber(m), mtu_length, m)
    if velocity <= 0.0:
        return math.nan
    guess = slack_fiber_length(mtu_length, m)
    return solve_fiber(0.0, 0.0, activation, mtu_length, guess, m)


@inner
def fiber_step(activation, fiber_length, previous_fiber_length, mtu_length, time_step, m):
    """Fiber length and velocity a time step later, with activation and musculotendon length of that later instant.

    BDF2: second order and L-stable (a barely active, stretched fiber relaxes at up to 8e4 /s), for one scalar solve.
    The previous fiber length is that of one step earlier.
    """
    base = bdf2_base(fiber_length, previous_fiber_length)
    guess = 2.0 * fiber_length - previous_fiber_length
    weight = 1.5 / time_step
    later = solve_fiber(weight, base, activation, mtu_length, guess, m)
    return later, weight * (later - base)


@inlined
def fiber_steps(later, state, i, n, mtu_length, time_step, m):
    """Writes the fiber lengths `later` (lanes,) of muscle i a time step later; `later` holds guesses.

    state: see `muscle_step`, but with activations of the later instant; (4 n, lanes). mtu_length: (n, lanes), of that
    instant too. It is `fiber_step` in every lane: plain Newton iterations of all lanes at once nearly always suffice,
    and where they do not settle in some lane, all are left to `fiber_step` itself.
    """
    weight = 1.5 / time_step
    shortest, tolerance = shortest_fiber(m), TOLERANCE * m.optimal_fiber_length
    for _ in range(QUICK_ITERATIONS):
        moving = 0
        for k in range(len(later)):
            base = bdf2_base(state[n + i, k], state[2 * n + i, k])
            _, move = newton_move(later[k], weight, base, state[i, k], mtu_length[i, k], m)
            x = max(later[k] + move, shortest)
            moving += not abs(x - later[k]) < tolerance
            later[k] = x
        if moving == 0:
            return
    for k in range(len(later)):
        fiber, previous = state[n + i, k], state[2 * n + i, k]
        later[k], _ = fiber_step(state[i, k], fiber, previous, mtu_length[i, k], time_step, m)


@inlined
def bdf2_base(fiber_length, previous_fiber_length):
    """The fiber length from which BDF2 makes a step of Euler's implicit rule, two thirds of the time step long."""
    return fma(4.0, fiber_length, -previous_fiber_length) * _THIRD
