"""The skeleton's equations of motion, compiled: accelerations from a `DynamicsTable`, for one arm or many."""

from typing import NamedTuple

import numpy as np

from drakearm.model.dynamics_table import DynamicsTable
from drakearm.muscle.compiled import compiled, fma, inner
from drakearm.muscle.elementary import sincos


class DynamicsLanes(NamedTuple):
    """Working memory of `forward_dynamics_lanes`."""

    product: np.ndarray  # (1 + 4 n_q + P, lanes)
    speed: np.ndarray  # (n_q n_q, lanes), products of two joint speeds
    mass: np.ndarray  # (n_q n_q, lanes), upper triangle
    slope: np.ndarray  # (S, lanes)


def make_dynamics_lanes(dynamics: DynamicsTable, n_q: int, lanes: int) -> DynamicsLanes:
    """Working memory for as many skeletons as there are lanes."""
    product = np.ones((1 + 4 * n_q + len(dynamics.factors), lanes))
    speed, mass = np.empty((n_q * n_q, lanes)), np.empty((n_q * n_q, lanes))
    return DynamicsLanes(product, speed, mass, np.empty((len(dynamics.slope_entry), lanes)))


_make_dynamics_lanes = inner(make_dynamics_lanes)


@inner
def equations_of_motion(q, v, dynamics, mass_coefficient, gravity_coefficient):
    """M (n_q, n_q) and h (n_q,) in M a = tau + h, at angles q and speeds v, SI: h is gravity minus Coriolis torques.

    mass_coefficient (K,), gravity_coefficient (G,): of the skeleton, for the terms of the table.
    """
    n_q = len(q)
    state, h, mass = np.empty((2 * n_q, 1)), np.zeros(n_q), np.empty((n_q, n_q))
    for j in range(n_q):
        state[j, 0], state[n_q + j, 0] = q[j], v[j]
    work = _make_dynamics_lanes(dynamics, n_q, 1)
    terms = mass_coefficient.reshape(-1, 1), gravity_coefficient.reshape(-1, 1)
    equations_lanes(state, h.reshape(-1, 1), dynamics, terms[0], terms[1], work)
    for row in range(n_q):
        for column in range(row, n_q):
            mass[row, column] = mass[column, row] = work.mass[n_q * row + column, 0]
    return mass, h


@compiled
def forward_dynamics(q, v, tau, dynamics):
    """Joint accelerations (n_q,) at angles q, speeds v and applied torques tau, SI: M a = tau + gravity - Coriolis."""
    n_q = len(q)
    mass, gravity = dynamics.mass_coefficient.reshape(-1, 1), dynamics.gravity_coefficient.reshape(-1, 1)
    state, a = np.empty((2 * n_q, 1)), np.empty(n_q)
    for j in range(n_q):
        state[j, 0], state[n_q + j, 0], a[j] = q[j], v[j], tau[j]
    work = _make_dynamics_lanes(dynamics, n_q, 1)
    forward_dynamics_lanes(state, a.reshape(-1, 1), dynamics, mass, gravity, work)
    return a


@inner
def forward_dynamics_lanes(state, force, dynamics, mass_coefficient, gravity_coefficient, work):
    """`forward_dynamics` for many skeletons, one per lane. force (n_q, lanes): torques, replaced by the accelerations.

    state: q and v, (2 n_q, lanes). mass_coefficient (K, lanes), gravity_coefficient (G, lanes): of each skeleton. work:
    see `make_dynamics_lanes`.
    """
    equations_lanes(state, force, dynamics, mass_coefficient, gravity_coefficient, work)
    _solve_lanes(work.mass, force)


@inner
def equations_lanes(state, force, dynamics, mass_coefficient, gravity_coefficient, work):
    """Adds gravity minus Coriolis torques to force (n_q, lanes), and writes the mass matrices into work.mass.

    The arguments are those of `forward_dynamics_lanes`. Only the upper triangles of the mass matrices are written.
    `DynamicsTable` explains the products, the factors and the slopes.
    """
    product, speed, mass, slope = work
    n_q, lanes = force.shape
    for j in range(n_q):
        for k in range(lanes):
            s, c = sincos(state[j, k])
            product[4 * j + 1, k] = c
            product[4 * j + 2, k] = s
            product[4 * j + 3, k] = c * c - s * s
            product[4 * j + 4, k] = 2.0 * c * s
        for i in range(n_q):
            for k in range(lanes):
                speed[n_q * i + j, k] = state[n_q + i, k] * state[n_q + j, k]
    for p in range(len(dynamics.factors)):
        first, second = dynamics.factors[p, 0], dynamics.factors[p, 1]
        for k in range(lanes):
            product[4 * n_q + 1 + p, k] = product[first, k] * product[second, k]
    for g in range(len(gravity_coefficient)):
        entry, p = dynamics.gravity_entry[g], dynamics.gravity_product[g]
        _add_product(force, entry, 1.0, gravity_coefficient, g, product, p)
    mass[:] = 0.0
    slope[:] = 0.0
    for t in range(len(mass_coefficient)):
        entry, p = n_q * dynamics.mass_entry[t, 0] + dynamics.mass_entry[t, 1], dynamics.mass_product[t]
        _add_product(mass, entry, 1.0, mass_coefficient, t, product, p)
    for d in range(len(dynamics.slope_term)):
        s, t, p = dynamics.slope_term[d, 0], dynamics.slope_term[d, 1], dynamics.slope_term[d, 2]
        _add_product(slope, s, float(dynamics.slope_term[d, 3]), mass_coefficient, t, product, p)
    for s in range(len(slope)):  # Christoffel: -dM_jk/dq_i v_i v_k for force j, 1/2 dM_jk/dq_i v_j v_k for force i
        row, column, i = dynamics.slope_entry[s, 0], dynamics.slope_entry[s, 1], dynamics.slope_entry[s, 2]
        _add_product(force, row, -1.0, slope, s, speed, n_q * i + column)
        if column != row:
            _add_product(force, column, -1.0, slope, s, speed, n_q * i + row)
        _add_product(force, i, 1.0 if column != row else 0.5, slope, s, speed, n_q * row + column)


@inner
def _add_product(total, row, factor, x, i, y, j):
    """Adds factor * x[i] * y[j] to total[row], in every lane."""
    for k in range(total.shape[1]):
        total[row, k] = fma(factor * x[i, k], y[j, k], total[row, k])


@inner
def _solve_lanes(mass, force):
    """Solves mass * a = force in every lane, with a in place of force. mass: its upper triangle, overwritten too."""
    n, lanes = force.shape
    for i in range(n):
        pivot = n * i + i
        for k in range(lanes):
            mass[pivot, k] = 1.0 / mass[pivot, k]
        for j in range(i + 1, n):
            below = n * j + i  # the lower triangle keeps the multiples of row i that are subtracted
            for k in range(lanes):
                mass[below, k] = mass[n * i + j, k] * mass[pivot, k]
            for c in range(j, n):
                _add_product(mass, n * j + c, -1.0, mass, below, mass, n * i + c)
            _add_product(force, j, -1.0, mass, below, force, i)
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            _add_product(force, i, -1.0, mass, n * i + j, force, j)
        for k in range(lanes):
            force[i, k] *= mass[n * i + i, k]


@inner
def solve(mass, force):
    """Solves mass * a = force for a positive definite mass matrix, and returns a. Overwrites mass and force."""
    n = len(force)
    for i in range(n):
        for j in range(i + 1, n):
            factor = mass[j, i] / mass[i, i]
            for k in range(i, n):
                mass[j, k] -= factor * mass[i, k]
            force[j] -= factor * force[i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            force[i] -= mass[i, k] * force[k]
        force[i] /= mass[i, i]
    return force
