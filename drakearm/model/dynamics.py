"""The skeleton's equations of motion, compiled: read off a MultibodyPlant, not written beside it.

Mass matrix and gravity torques of a chain of revolute joints are trigonometric polynomials of degree 2 in each joint
angle. A plant that is sampled at five angles a joint therefore gives their coefficients exactly, loads included.
"""

from itertools import product
from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from drakearm.errors import ArmError
from drakearm.muscle.compiled import compiled

_ANGLES = 2.0 * np.pi / 5.0 * np.arange(5)
_NEGLIGIBLE = 1e-14  # of the largest coefficient


class DynamicsTable(NamedTuple):
    """Terms of the mass matrix and of the gravity torques; those with coefficient 0 are left out.

    A term is coefficient * product over the joints j of the function basis[j] of q_j: 1, cos, sin, cos of the double,
    sin of the double angle. mass_entry: row and column of the mass matrix, row <= column. gravity_entry: the
    coordinate.
    """

    mass_entry: np.ndarray  # (K, 2)
    mass_basis: np.ndarray  # (K, n_q)
    mass_coefficient: np.ndarray  # (K,)
    gravity_entry: np.ndarray  # (G,)
    gravity_basis: np.ndarray  # (G, n_q)
    gravity_coefficient: np.ndarray  # (G,)


def read_dynamics(plant: MultibodyPlant) -> DynamicsTable:
    """The table of a finalized plant that is a chain of revolute joints. Raises ArmError for any other plant."""
    n_q = plant.num_positions()
    context = plant.CreateDefaultContext()
    mass, gravity = [], []
    grid = np.array(list(product(_ANGLES, repeat=n_q)))
    for q in grid:
        plant.SetPositions(context, q)
        mass.append(plant.CalcMassMatrix(context))
        gravity.append(plant.CalcGravityGeneralizedForces(context))
    rows, columns = np.triu_indices(n_q)
    bases = np.array(list(product(range(5), repeat=n_q)))
    design = np.prod([_basis(grid[:, j])[:, bases[:, j]] for j in range(n_q)], axis=0)
    mass_terms = np.linalg.solve(design, np.array(mass)[:, rows, columns])
    gravity_terms = np.linalg.solve(design, np.array(gravity))
    m, entry = np.nonzero(np.abs(mass_terms) > _NEGLIGIBLE * np.abs(mass_terms).max())
    g, coordinate = np.nonzero(np.abs(gravity_terms) > _NEGLIGIBLE * np.abs(gravity_terms).max())
    table = DynamicsTable(
        np.stack([rows[entry], columns[entry]], axis=1),
        bases[m],
        mass_terms[m, entry],
        coordinate,
        bases[g],
        gravity_terms[g, coordinate],
    )
    _check(plant, context, table)
    return table


def _check(plant: MultibodyPlant, context: Context, table: DynamicsTable) -> None:
    """Compares with the plant off the grid, where only a chain of revolute joints agrees."""
    q, v = np.full(plant.num_positions(), 0.7), np.ones(plant.num_velocities())
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)
    expected = plant.EvalTimeDerivatives(context).get_generalized_velocity().CopyToVector()
    actual = forward_dynamics(q, v, np.zeros(len(q)), table)
    if not np.allclose(actual, expected, rtol=1e-6, atol=1e-6):
        raise ArmError("The skeleton cannot be compiled: expected a chain of revolute joints.")


def _basis(q: np.ndarray) -> np.ndarray:
    """The five functions (..., 5) of angles (...)."""
    return np.stack([np.ones_like(q), np.cos(q), np.sin(q), np.cos(2 * q), np.sin(2 * q)], axis=-1)


@compiled
def _values_and_slopes(q):
    """The five functions of every joint angle and their derivatives, each (n_q, 5)."""
    values, slopes = np.empty((len(q), 5)), np.empty((len(q), 5))
    for j in range(len(q)):
        c, s = np.cos(q[j]), np.sin(q[j])
        c2, s2 = c * c - s * s, 2.0 * c * s
        values[j] = (1.0, c, s, c2, s2)
        slopes[j] = (0.0, -s, c, -2.0 * s2, 2.0 * c2)
    return values, slopes


@compiled
def forward_dynamics(q, v, tau, dynamics):
    """Joint accelerations (n_q,) at angles q, speeds v and applied torques tau: M a = tau + gravity - Coriolis."""
    n_q = len(q)
    values, slopes = _values_and_slopes(q)
    mass = np.zeros((n_q, n_q))
    force = tau.copy()
    for k in range(len(dynamics.gravity_entry)):
        term = dynamics.gravity_coefficient[k]
        for j in range(n_q):
            term *= values[j, dynamics.gravity_basis[k, j]]
        force[dynamics.gravity_entry[k]] += term
    for k in range(len(dynamics.mass_entry)):
        row, column = dynamics.mass_entry[k, 0], dynamics.mass_entry[k, 1]
        basis, coefficient = dynamics.mass_basis[k], dynamics.mass_coefficient[k]
        term = coefficient
        for j in range(n_q):
            term *= values[j, basis[j]]
        mass[row, column] += term
        if column != row:
            mass[column, row] += term
        for i in range(n_q):  # Christoffel: minus dM_jk/dq_i v_i v_k for force j, plus half of it for force i
            if basis[i] == 0:
                continue
            slope = coefficient
            for j in range(n_q):
                slope *= slopes[j, basis[j]] if j == i else values[j, basis[j]]
            force[row] -= slope * v[i] * v[column]
            if column != row:
                force[column] -= slope * v[i] * v[row]
                force[i] += slope * v[row] * v[column]
            else:
                force[i] += 0.5 * slope * v[row] * v[column]
    return solve(mass, force)


@compiled
def solve(mass, force):
    """Solves mass * a = force for a positive definite mass matrix, which it overwrites, as it does force."""
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
