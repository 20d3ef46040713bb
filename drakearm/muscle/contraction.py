"""Contraction dynamics of one muscle: tendon force, fiber velocity, and the fiber length in time and in equilibrium.

`m` is a record of `MUSCLE_DTYPE`. A pennated fiber of length l keeps its width, so its length along the tendon is
sqrt(l^2 - width^2). A fiber length below the minimum is replaced by the minimum, as in OpenSim.
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
SHORTEST = 0.01  # times optimal fiber length: lower bound in time steps and equilibria, also of unpennated fibers
ITERATIONS = 100  # at most, of `solve_fiber`
QUICK_ITERATIONS = 6  # at most, of Newton's method in all lanes at once
TOLERANCE = 1e-8  # times optimal fiber length: of the last Newton move; the remaining error is about its square


@inlined
def shortest_fiber(m):
    """Lower bound (m) of the fiber length."""
    return max(m.minimum_fiber_length, SHORTEST * m.optimal_fiber_length)


@inlined
def tendon_force(fiber_length, mtu_length, m):
    """Force (N) of a compliant tendon, and its derivatives with respect to fiber and musculotendon length (N/m)."""
    fiber_length = max(fiber_length, m.minimum_fiber_length)
    along = math.sqrt(fma(fiber_length, fiber_length, -m.fiber_width * m.fiber_width))
    per_slack_length = 1.0 / m.tendon_slack_length  # the same in all lanes: a loop over lanes divides only once
    force, slope = tendon_force_strain(fma(mtu_length - along, per_slack_length, -1.0), m)
    by_mtu = slope * per_slack_length * m.max_isometric_force
    return force * m.max_isometric_force, -by_mtu * fiber_length / along, by_mtu


@inlined
def rigid_fiber(mtu_length, mtu_velocity, m):
    """Length (m) and velocity (m/s) of a fiber on a rigid tendon, and the cosine of its pennation angle."""
    along = max(mtu_length - m.tendon_slack_length, 0.0)
    fiber_length = math.sqrt(along**2 + m.fiber_width**2)
    shortest = shortest_fiber(m)
    if fiber_length <= shortest:
        return shortest, 0.0, math.sqrt(1.0 - (m.fiber_width / shortest) ** 2)
    cosine = along / fiber_length
    return fiber_length, mtu_velocity * cosine, cosine


@inlined
def rigid_tendon_force(activation, mtu_length, mtu_velocity, m):
    """Force (N) of a fiber on its rigid tendon, and three derivatives of this force.

    They are with respect to activation, musculotendon length and musculotendon velocity.
    """
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
    """The fiber velocity and its derivatives as fractions with one denominator, because a division takes long.

    Returns unit (m/s), numerator, denominator, by_activation, by_length and by_mtu_length. The velocity is numerator *
    unit / denominator. Its derivatives with respect to activation, fiber length and musculotendon length are
    by_activation, -by_length and by_mtu_length, each times unit / denominator.
    """
    at_minimum = fiber_length <= m.minimum_fiber_length
    fiber_length = max(fiber_length, m.minimum_fiber_length)
    a = min(max(activation, m.minimum_activation), 1.0)
    free = 1.0 if a == activation else 0.0
    # The same in all lanes: a loop over lanes divides only once.
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
    # Decrease of the tendon force along the fiber, per meter of fiber length.
    loss = fma(by_strain, secant * secant, tendon * (m.fiber_width * m.fiber_width) * inverse_along**3)
    by_length = by_active * fma(passive_slope, per_optimal_length, loss)
    by_length = fma(by_isometric, a * shape_slope * per_optimal_length, by_length)
    by_activation = free * (numerator * scale_slope / scale - by_isometric * shape)
    return unit, numerator, denominator, by_activation, by_length, by_active * by_strain * secant


@inlined
def fiber_velocity(activation, fiber_length, mtu_length, m):
    """Fiber velocity (m/s) and its derivatives with respect to activation, fiber length and musculotendon length.

    At this velocity the contractile element exerts the force of the tendon minus that of the passive element
    (Thelen 2003, eq. 6). At its minimum length a fiber can only lengthen.
    """
    unit, numerator, denominator, by_activation, by_length, by_mtu_length = _velocity_fraction(
        activation, fiber_length, mtu_length, m
    )
    unit /= denominator
    return unit * numerator, unit * by_activation, -unit * by_length, unit * by_mtu_length


@inlined
def slack_fiber_length(mtu_length, m):
    """Fiber length (m) at which the tendon has exactly its slack length."""
    return math.sqrt(max(mtu_length - m.tendon_slack_length, 0.0) ** 2 + m.fiber_width**2)


@inlined
def newton_move(x, weight, base, activation, mtu_length, m):
    """One iteration of `solve_fiber` at fiber length x (m): the residual of its equation, and Newton's move (m) from x.

    The residual is multiplied by the denominator of the velocity, which saves a division.
    """
    unit, numerator, denominator, _, by_length, _ = _velocity_fraction(activation, x, mtu_length, m)
    residual = fma(unit, numerator, -weight * (x - base) * denominator)
    return residual, residual / fma(weight, denominator, unit * by_length)


@inner
def solve_fiber(weight, base, activation, mtu_length, guess, m):
    """Fiber length x (m) that solves weight * (x - base) = fiber_velocity(x), but at least `shortest_fiber`.

    The left side rises with x and the right side falls. So the root is not above both the base and the fiber length at
    which the tendon goes slack. Every iteration narrows a bracket around the root. A Newton move that would leave the
    bracket is replaced by bisection.
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
    """Fiber length (m) at which a resting fiber and its tendon exert the same force.

    NaN if the musculotendon path is so short that even the shortest fiber leaves the tendon slack.
    """
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
    """Fiber length (m) and velocity (m/s) one time step (s) later, by BDF2: one scalar equation is solved.

    activation, mtu_length: at the later instant. previous_fiber_length: one time step before fiber_length. BDF2 is of
    second order. It is also L-stable, which is needed because a barely active, stretched fiber relaxes at rates up to
    8e4 /s.
    """
    base = bdf2_base(fiber_length, previous_fiber_length)
    guess = 2.0 * fiber_length - previous_fiber_length
    weight = 1.5 / time_step
    later = solve_fiber(weight, base, activation, mtu_length, guess, m)
    return later, weight * (later - base)


@inlined
def fiber_steps(later, state, i, n, mtu_length, time_step, m):
    """`fiber_step` of muscle i in every lane: replaces guesses in `later` (lanes,) by the later fiber lengths.

    state (4 n, lanes): as in `muscle_step`, but its activations are those at the later instant. mtu_length (n, lanes):
    at the later instant too. Newton's method without a bracket, in all lanes at once, is nearly always enough. If it
    does not converge in some lane, `fiber_step` computes every lane.
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
    """The fiber length (m) from which an implicit Euler step over 2/3 of the time step gives the step of BDF2."""
    return fma(4.0, fiber_length, -previous_fiber_length) * _THIRD
