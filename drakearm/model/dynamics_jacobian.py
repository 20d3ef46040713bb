"""First derivatives of the skeleton's equations of motion, for automatic differentiation of `CompiledSkeleton`."""

import numpy as np

from drakearm.model.dynamics import forward_dynamics, solve
from drakearm.muscle.compiled import compiled, inner


@compiled
def linearize_dynamics(q, v, tau, dynamics):
    """Joint accelerations (n_q,), as of `forward_dynamics`, and their Jacobian (n_q, 3 n_q) by q, v and tau, in SI.

    M a = h, so M da = dh - dM a. `by` collects the right side, term by term of the table.
    """
    n_q = len(q)
    functions = _functions(q)
    a = forward_dynamics(q, v, tau, dynamics)
    mass = np.zeros((n_q, n_q))
    by = np.zeros((n_q, 3 * n_q))
    for k in range(len(dynamics.gravity_entry)):
        for i in range(n_q):
            slope = dynamics.gravity_coefficient[k] * _product(functions, dynamics.gravity_basis[k], i, -1)
            by[dynamics.gravity_entry[k], i] += slope
    for k in range(len(dynamics.mass_entry)):
        row, column, basis = dynamics.mass_entry[k, 0], dynamics.mass_entry[k, 1], dynamics.mass_basis[k]
        share = dynamics.mass_coefficient[k] * (0.5 if row == column else 1.0)  # added twice, at row and at column
        term = share * _product(functions, basis, -1, -1)
        mass[row, column] += term
        mass[column, row] += term
        for i in range(n_q):
            if basis[i] == 0:
                continue
            slope = share * _product(functions, basis, i, -1)
            by[row, i] -= slope * a[column]
            by[column, i] -= slope * a[row]
            # The Coriolis forces of this slope: -slope v_i v_column for joint row, -slope v_i v_row for joint column
            # and slope v_row v_column for joint i.
            by[row, n_q + i] -= slope * v[column]
            by[row, n_q + column] -= slope * v[i]
            by[column, n_q + i] -= slope * v[row]
            by[column, n_q + row] -= slope * v[i]
            by[i, n_q + row] += slope * v[column]
            by[i, n_q + column] += slope * v[row]
            for j in range(n_q):
                curvature = share * _product(functions, basis, i, j)
                by[row, j] -= curvature * v[i] * v[column]
                by[column, j] -= curvature * v[i] * v[row]
                by[i, j] += curvature * v[row] * v[column]
    for i in range(n_q):
        by[i, 2 * n_q + i] = 1.0
    for k in range(3 * n_q):
        by[:, k] = solve(mass.copy(), by[:, k].copy())
    return a, by


@inner
def _functions(q):
    """The five factors of every joint angle, their first and their second derivatives, (3, n_q, 5)."""
    functions = np.empty((3, len(q), 5))
    for j in range(len(q)):
        c, s = np.cos(q[j]), np.sin(q[j])
        c2, s2 = c * c - s * s, 2.0 * c * s
        functions[0, j] = (1.0, c, s, c2, s2)
        functions[1, j] = (0.0, -s, c, -2.0 * s2, 2.0 * c2)
        functions[2, j] = (0.0, -c, -s, -4.0 * c2, -4.0 * s2)
    return functions


@inner
def _product(functions, basis, i, j):
    """A term without its coefficient, differentiated by q_i and by q_j; an index of -1 means no differentiation."""
    product = 1.0
    for joint in range(len(basis)):
        product *= functions[(joint == i) + (joint == j), joint, basis[joint]]
    return product
