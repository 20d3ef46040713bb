"""Static optimization: the smallest activations that make muscles exert given joint torques (Anderson and Pandy 2001).

`muscles` is `Arm.muscle_table` and `paths` is `Arm.path_table`; n muscles, n_q coordinates.
"""

import math

import numpy as np

from drakearm.model.dynamics import solve
from drakearm.model.musculature import mtu_velocity, muscle_geometry
from drakearm.muscle.compiled import compiled, inner
from drakearm.muscle.contraction import (
    ITERATIONS,
    TOLERANCE,
    fiber_velocity,
    rigid_tendon_force,
    shortest_fiber,
    slack_fiber_length,
    tendon_force,
)

RESERVE_WEIGHT = 1e4  # 1/torque_unit^2, of squared reserve torques, where squared activations have weight 1
NEGLIGIBLE = 0.01  # Nm, reserve torque up to which the muscles count as strong enough
_WEAK = 20.0  # Nm, the sum of what all muscles can exert, below which a limb is weak; in arm14 it is 90 or more
_LEAST = 1e-15  # Nm, less than any limb exerts
_ROUNDS = 20  # at most; each linearizes the muscles once
_SETTLED = 1e-4  # change of the activations in the last round; the remaining error is about its square
_GUESSED_STRAIN = 0.02  # of tendons, for the first guess of the fiber lengths
_DUAL_STEPS = 50
_DUAL_TOLERANCE = 1e-7  # torque_unit


@inner
def steady_force(activation, mtu_length, mtu_speed, guess, m):
    """Tendon force (N) of a muscle whose tendon strain is constant in time.

    Returns the force, its slope with respect to the activation, and the fiber length (m). The fiber moves at the speed
    of its path, and its length is the one at which it exerts the same force as its tendon. At rest this is the
    equilibrium. In movement only the rate of the tendon strain is neglected. With rigid tendons the force would be
    linear in the activation, except for `velocity_scale`. But rigid tendons misjudge the strength in a posture: tendons
    are up to ten fiber lengths long, and they stretch by up to a third of a fiber length. guess: of the fiber length
    (m); any number.
    """
    if m.rigid_tendon:
        force, by_activation, _, _ = rigid_tendon_force(activation, mtu_length, mtu_speed, m)
        return force, by_activation, guess
    low = shortest_fiber(m)
    high = max(slack_fiber_length(mtu_length, m), low) * (1.0 + 1e-9)
    x = min(max(guess, low), high)
    by_activation = slope = 0.0
    for _ in range(ITERATIONS):
        cosine = math.sqrt(1.0 - (m.fiber_width / x) ** 2)
        velocity, by_activation, by_length, _ = fiber_velocity(activation, x, mtu_length, m)
        residual = velocity - mtu_speed * cosine
        slope = by_length - mtu_speed * m.fiber_width**2 / (x**3 * cosine)
        if residual > 0.0:
            low = x
        else:
            high = x
        move = -residual / slope if slope < 0.0 else math.inf
        if not (low <= x + move <= high):
            move = 0.5 * (low + high) - x
        x += move
        if abs(move) < TOLERANCE * m.optimal_fiber_length:
            break
    force, by_length, _ = tendon_force(x, mtu_length, m)
    if force > 0.0 and slope < 0.0:
        return force, -by_length * by_activation / slope, x
    return force, 0.0, x


@inner
def _smallest_controls(gain, desired, lower, x):
    """Writes the x (n,) in [lower, 1] with the least |x|^2 + RESERVE_WEIGHT |desired - x gain|^2.

    gain: (n, n_q), desired: (n_q,), both in `torque_unit`. The method is Newton's on the dual problem, in which only
    n_q numbers p are unknown: x = clip(gain p, lower, 1), and p is RESERVE_WEIGHT times the weighted reserve torque.
    The dual cost is convex and its gradient is piecewise linear. Steps are halved until they do not overshoot, so the
    method converges from every start.

    Matrix products are written as loops. BLAS would give last bits that depend on the position of the arrays in memory.
    """
    n, n_q = gain.shape
    p, later_p = np.zeros(n_q), np.zeros(n_q)
    gradient, move, hessian = np.empty(n_q), np.empty(n_q), np.empty((n_q, n_q))
    _dual_gradient(p, gain, desired, lower, x, gradient)
    for _ in range(_DUAL_STEPS):
        largest = 0.0
        for j in range(n_q):
            largest = max(largest, abs(gradient[j]))
        if largest < _DUAL_TOLERANCE:
            break
        for j in range(n_q):
            move[j] = -gradient[j]
            for k in range(n_q):
                hessian[j, k] = 1.0 / RESERVE_WEIGHT if j == k else 0.0
        for i in range(n):
            if lower[i] < x[i] < 1.0:
                for j in range(n_q):
                    for k in range(n_q):
                        hessian[j, k] += gain[i, j] * gain[i, k]
        solve(hessian, move)
        decline = -_dot(gradient, move)
        while True:
            for j in range(n_q):
                later_p[j] = p[j] + move[j]
            _dual_gradient(later_p, gain, desired, lower, x, gradient)
            if not _dot(gradient, move) > 0.1 * decline:
                break
            decline *= 0.5
            for j in range(n_q):
                move[j] *= 0.5
        p[:] = later_p


@inner
def _dual_gradient(p, gain, desired, lower, x, gradient):
    """Writes the x (n,) that belongs to p (n_q,), and the gradient (n_q,) of the dual cost at p."""
    n, n_q = gain.shape
    for j in range(n_q):
        gradient[j] = p[j] / RESERVE_WEIGHT - desired[j]
    for i in range(n):
        total = 0.0
        for j in range(n_q):
            total += gain[i, j] * p[j]
        x[i] = min(max(total, lower[i]), 1.0)
        for j in range(n_q):
            gradient[j] += x[i] * gain[i, j]


@inner
def _dot(x, y):
    total = 0.0
    for j in range(len(x)):
        total += x[j] * y[j]
    return total


@compiled
def torque_unit(moment_arm, muscles):
    """The unit of torque (Nm) in static optimization: 1 Nm, but less in a weak limb, like that of a small animal.

    moment_arm: (n, n_q), m. In a fixed unit, the torques of such a limb would count less than its activations.
    """
    total = 0.0
    for i in range(len(muscles)):
        largest = 0.0
        for j in range(moment_arm.shape[1]):
            largest = max(largest, abs(moment_arm[i, j]))
        total += muscles[i].max_isometric_force * largest
    return min(max(total / _WEAK, _LEAST), 1.0)


def negligible_reserve(q: np.ndarray, muscles: np.ndarray, paths: np.ndarray) -> float:
    """The reserve torque (Nm) up to which muscles count as strong enough at q (n_q,), rad: NEGLIGIBLE `torque_unit`."""
    return NEGLIGIBLE * float(torque_unit(muscle_geometry(q, muscles, paths)[1], muscles))


@compiled
def static_activations(q, v, tau, guess, weighting, muscles, paths):
    """Activations (n,) with the least sum of squares that exert joint torques tau (n_q,), Nm; and the reserve torques.

    The reserve torques (n_q,), Nm, are what the muscles lack to exert tau. q, v: joint angles and speeds (n_q,). guess:
    activations (n,) to start from. Activations stay in [minimum_activation, 1]. If these cannot exert tau, the sum of
    squares of weighting * reserve is as small as possible; the matrix `weighting` is (n_q, n_q), the identity or
    `acceleration_weighting`. Muscle forces are not linear in the activation, because it also changes the fiber velocity
    and stretches the tendon. So a few rounds linearize the muscles around the present activations and solve a small
    quadratic program, until the activations do not change any more.
    """
    n, n_q = len(muscles), len(q)
    length, moment_arm = muscle_geometry(q, muscles, paths)
    unit = torque_unit(moment_arm, muscles)
    lower, fiber = np.empty(n), np.empty(n)
    for i in range(n):
        lower[i] = muscles[i].minimum_activation
        fiber[i] = slack_fiber_length(length[i] - _GUESSED_STRAIN * muscles[i].tendon_slack_length, muscles[i])
    a = np.minimum(np.maximum(guess, lower), 1.0)
    later = np.empty(n)
    gain = np.empty((n, n_q))
    weighted_gain, weighted_desired = np.empty((n, n_q)), np.empty(n_q)
    desired, reserve = np.empty(n_q), np.empty(n_q)
    for _ in range(_ROUNDS):
        for j in range(n_q):
            reserve[j] = tau[j] / unit
        desired[:] = 0.0
        for i in range(n):
            speed = mtu_velocity(i, moment_arm, v)
            force, slope, fiber[i] = steady_force(a[i], length[i], speed, fiber[i], muscles[i])
            for j in range(n_q):
                reserve[j] -= moment_arm[i, j] * force / unit
                gain[i, j] = moment_arm[i, j] * slope / unit
                desired[j] += a[i] * gain[i, j]
        for j in range(n_q):
            weighted_desired[j] = 0.0
            for k in range(n_q):
                weighted_desired[j] += weighting[j, k] * (desired[k] + reserve[k])
            for i in range(n):
                weighted_gain[i, j] = 0.0
                for k in range(n_q):
                    weighted_gain[i, j] += weighting[j, k] * gain[i, k]
        _smallest_controls(weighted_gain, weighted_desired, lower, later)
        largest = 0.0
        for i in range(n):
            move = later[i] - a[i]
            largest = max(largest, abs(move))
            for j in range(n_q):
                reserve[j] -= move * gain[i, j]
            a[i] = later[i]
        if largest < _SETTLED:
            break
    return a, reserve * unit


@compiled
def acceleration_weighting(mass, priority):
    """The weighting (n_q, n_q) of `static_activations` by which joints miss their accelerations as little as possible.

    mass: the mass matrix (n_q, n_q). priority: (n_q,), from 0 to 1, of each joint's squared error. The error of a joint
    is given by the torque on this joint alone that would make up for it. Without this weighting a joint that is strong
    enough would still fail where another one is too weak, because its torque is meant for accelerations of all joints.
    """
    n_q = len(priority)
    weighting = np.empty((n_q, n_q))
    for k in range(n_q):
        unit = np.zeros(n_q)
        unit[k] = 1.0
        weighting[:, k] = solve(mass.copy(), unit)
    for j in range(n_q):
        weighting[j] *= math.sqrt(priority[j]) / weighting[j, j]
    return weighting


@compiled
def excitations_to_reach(desired, activation, time_step, muscles):
    """Excitations (n,) that bring activations (n,) to the desired ones (n,), or as close as possible, in a time step.

    The excitations are held for time_step (s). The time constant of each muscle (see `activation_rate`) is the one at
    its present activation.
    """
    excitation = np.empty(len(muscles))
    for i in range(len(muscles)):
        m = muscles[i]
        speed = 0.5 + 1.5 * activation[i]
        rate = 1.0 / (m.activation_time * speed) if desired[i] > activation[i] else speed / m.deactivation_time
        reached = -math.expm1(-rate * time_step)  # fraction of the way to the excitation that the activation covers
        excitation[i] = min(max(activation[i] + (desired[i] - activation[i]) / reached, 0.0), 1.0)
    return excitation
