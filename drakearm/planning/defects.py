"""The defects of the collocation, all intervals in one compiled call, with derivatives.

Hermite-Simpson collocation with torques that are linear between the knots (Hargraves and Paris 1987). A defect is
evaluated in the middle of an interval: the slope of the cubic splines minus the derivative of the state there. It is
scaled like that of Drake's DirectCollocationConstraint.
"""

import numpy as np

from drakearm.model.dynamics_jacobian import linearize_dynamics
from drakearm.muscle.compiled import compiled


@compiled
def state_derivative(z, dynamics):
    """The derivative (2 n_q,) of the state at z = (q, v, tau), and its Jacobian (2 n_q, 3 n_q)."""
    n_q = len(z) // 3
    a, by = linearize_dynamics(z[:n_q], z[n_q : 2 * n_q], z[2 * n_q :], dynamics)
    derivative = np.concatenate((z[n_q : 2 * n_q], a))
    jacobian = np.zeros((2 * n_q, 3 * n_q))
    jacobian[n_q:] = by
    for i in range(n_q):
        jacobian[i, n_q + i] = 1.0
    return derivative, jacobian


@compiled
def defects(knots, step, dynamics):
    """The defects (N - 1, 2 n_q) of N knots (N, 3 n_q), each q, v and tau, and Jacobians (N - 1, 2 n_q, 6 n_q).

    The columns of an interval's Jacobian are the derivatives by its first knot, then by its second. step: s, between
    the knots.
    """
    n_knots, n_z = knots.shape
    n_x = 2 * n_z // 3
    slope = np.empty((n_knots, n_x))
    slope_by = np.empty((n_knots, n_x, n_z))
    for k in range(n_knots):
        slope[k], slope_by[k] = state_derivative(knots[k], dynamics)
    defect = np.empty((n_knots - 1, n_x))
    jacobian = np.empty((n_knots - 1, n_x, 2 * n_z))
    for k in range(n_knots - 1):
        middle = 0.5 * (knots[k] + knots[k + 1])
        middle[:n_x] += step / 8.0 * (slope[k] - slope[k + 1])
        derivative, by_middle = state_derivative(middle, dynamics)
        defect[k] = 1.5 / step * (knots[k + 1, :n_x] - knots[k, :n_x]) - 0.25 * (slope[k] + slope[k + 1]) - derivative
        by_first, by_second = 0.5 * np.eye(n_z), 0.5 * np.eye(n_z)
        by_first[:n_x] += step / 8.0 * slope_by[k]
        by_second[:n_x] -= step / 8.0 * slope_by[k + 1]
        jacobian[k, :, :n_z] = -0.25 * slope_by[k] - by_middle @ by_first
        jacobian[k, :, n_z:] = -0.25 * slope_by[k + 1] - by_middle @ by_second
        for i in range(n_x):
            jacobian[k, i, i] -= 1.5 / step
            jacobian[k, i, n_z + i] += 1.5 / step
    return defect, jacobian
