"""The skeleton's equations of motion, compiled: read off a MultibodyPlant, not written beside it.

Mass matrix and gravity torques of a chain of revolute joints are trigonometric polynomials of degree 2 in each joint
angle. A plant that is sampled at five angles a joint therefore gives their coefficients exactly, loads included.
"""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from drakearm.errors import ArmError
from drakearm.muscle.compiled import compiled, inlined, inner
from drakearm.muscle.elementary import sincos

_ANGLES = 2.0 * np.pi / 5.0 * np.arange(5)
_NEGLIGIBLE = 1e-14  # of the largest coefficient


class DynamicsTable(NamedTuple):
    """Terms of the mass matrix and of the gravity torques; those with coefficient 0 are left out.

    A term is coefficient * product over the joints j of the function basis[j] of q_j: 1, cos, sin, cos of the double,
    sin of the double angle. mass_entry: row and column of the mass matrix, row <= column. gravity_entry: the
    coordinate. Coefficients of N skeletons follow each other, (N K,) and (N G,), see `stack_dynamics`.
    """

    mass_entry: np.ndarray  # (K, 2)
    mass_basis: np.ndarray  # (K, n_q)
    mass_coefficient: np.ndarray  # (K,)
    gravity_entry: np.ndarray  # (G,)
    gravity_basis: np.ndarray  # (G, n_q)
    gravity_coefficient: np.ndarray  # (G,)


class DynamicsLanes(NamedTuple):
    """Working memory of `forward_dynamics_lanes`, and the coefficients of the skeleton in each lane."""

    mass_coefficient: np.ndarray  # (K, lanes)
    gravity_coefficient: np.ndarray  # (G, lanes)
    basis: np.ndarray  # (n_q, 5, lanes), the five functions of every joint angle
    term: np.ndarray  # (lanes,)
    mass: np.ndarray  # (n_q, n_q, lanes), upper triangle


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
    arrays = (
        np.stack([rows[entry], columns[entry]], axis=1),
        bases[m],
        mass_terms[m, entry],
        coordinate,
        bases[g],
        gravity_terms[g, coordinate],
    )
    table = DynamicsTable(*(np.ascontiguousarray(array) for array in arrays))
    _check(plant, context, table)
    return table


def stack_dynamics(tables: Sequence[DynamicsTable]) -> DynamicsTable:
    """One table of N skeletons with equally many joints: all terms that any of them has, 0 where one lacks it.

    It has the array types of a table of one skeleton, so that the compiler need not work twice.
    """

    def stack(entries: list[np.ndarray], bases: list[np.ndarray], coefficients: list[np.ndarray]) -> list[np.ndarray]:
        terms = np.concatenate([np.column_stack(term) for term in zip(bases, entries, strict=True)])
        union, place = np.unique(terms, axis=0, return_inverse=True)
        stacked = np.zeros((len(tables), len(union)))
        owner = np.repeat(np.arange(len(tables)), [len(c) for c in coefficients])
        stacked[owner, place.ravel()] = np.concatenate(coefficients)
        n_q = bases[0].shape[1]
        return [union[:, n_q:].reshape(-1, *entries[0].shape[1:]), union[:, :n_q], stacked.ravel()]

    columns = [list(column) for column in zip(*tables, strict=True)]
    return DynamicsTable(*(np.ascontiguousarray(array) for array in stack(*columns[:3]) + stack(*columns[3:])))


def _check(plant: MultibodyPlant, context: Context, table: DynamicsTable) -> None:
    """Compares with the plant off the grid, where only a chain of revolute joints agrees."""
    n_q = plant.num_positions()
    q, v = np.full(n_q, 0.7), np.ones(n_q)
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)
    expected = plant.EvalTimeDerivatives(context).get_generalized_velocity().CopyToVector()
    functions = np.stack([_basis(q), _slopes(q)])
    force, mass = np.zeros(n_q), np.zeros((n_q, n_q))
    joints = np.arange(n_q)
    for entry, basis, c in zip(table.gravity_entry, table.gravity_basis, table.gravity_coefficient, strict=True):
        force[entry] += c * functions[0, joints, basis].prod()
    for (row, column), basis, c in zip(table.mass_entry, table.mass_basis, table.mass_coefficient, strict=True):
        share = c / 2 if row == column else c  # row and column both take it
        derivative = share * np.array([functions[(joints == i).astype(int), joints, basis].prod() for i in joints])
        mass[[row, column], [column, row]] += share * functions[0, joints, basis].prod() * (1 + (row == column))
        force[row] -= derivative @ v * v[column]
        force[column] -= derivative @ v * v[row]
        force += derivative * v[row] * v[column]
    if not np.allclose(np.linalg.solve(mass, force), expected, rtol=1e-6, atol=1e-6):
        raise ArmError("The skeleton cannot be compiled: expected a chain of revolute joints.")


def _basis(q: np.ndarray) -> np.ndarray:
    """The five functions (..., 5) of angles (...)."""
    return np.stack([np.ones_like(q), np.cos(q), np.sin(q), np.cos(2 * q), np.sin(2 * q)], axis=-1)


def _slopes(q: np.ndarray) -> np.ndarray:
    """Their derivatives (..., 5)."""
    return np.stack([np.zeros_like(q), -np.sin(q), np.cos(q), -2 * np.sin(2 * q), 2 * np.cos(2 * q)], axis=-1)


@compiled
def make_dynamics_lanes(mass_coefficient, gravity_coefficient, n_q):
    """Working memory for skeletons side by side with these coefficients, (K, lanes) and (G, lanes)."""
    lanes = mass_coefficient.shape[1]
    basis, term, mass = np.empty((n_q, 5, lanes)), np.empty(lanes), np.empty((n_q, n_q, lanes))
    return DynamicsLanes(mass_coefficient, gravity_coefficient, basis, term, mass)


@compiled
def forward_dynamics(q, v, tau, dynamics):
    """Joint accelerations (n_q,) at angles q, speeds v and applied torques tau: M a = tau + gravity - Coriolis."""
    n_q = len(q)
    mass_coefficient, gravity_coefficient = dynamics.mass_coefficient, dynamics.gravity_coefficient
    work = make_dynamics_lanes(mass_coefficient.reshape(-1, 1), gravity_coefficient.reshape(-1, 1), n_q)
    state, a = np.empty((2 * n_q, 1)), np.empty(n_q)
    for j in range(n_q):
        state[j, 0], state[n_q + j, 0], a[j] = q[j], v[j], tau[j]
    forward_dynamics_lanes(state, a.reshape(-1, 1), dynamics, work)
    return a


@inner
def forward_dynamics_lanes(state, force, dynamics, work):
    """`forward_dynamics` for skeletons side by side: turns torques (n_q, lanes) into accelerations, in place.

    state: q and v, (2 n_q, lanes).
    """
    mass_coefficient, gravity_coefficient, basis, term, mass = work
    n_q, lanes = force.shape
    for j in range(n_q):
        for k in range(lanes):
            s, c = sincos(state[j, k])
            basis[j, 1, k] = c
            basis[j, 2, k] = s
            basis[j, 3, k] = c * c - s * s
            basis[j, 4, k] = 2.0 * c * s
    for g in range(len(gravity_coefficient)):
        entry = dynamics.gravity_entry[g]
        _term(g, gravity_coefficient, dynamics.gravity_basis, -1, basis, term)
        for k in range(lanes):
            force[entry, k] += term[k]
    mass[:] = 0.0
    for t in range(len(mass_coefficient)):
        row, column = dynamics.mass_entry[t, 0], dynamics.mass_entry[t, 1]
        _term(t, mass_coefficient, dynamics.mass_basis, -1, basis, term)
        for k in range(lanes):
            mass[row, column, k] += term[k]
        for i in range(n_q):  # Christoffel: minus dM_jk/dq_i v_i v_k for force j, plus half of it for force i
            if dynamics.mass_basis[t, i] == 0:
                continue
            _term(t, mass_coefficient, dynamics.mass_basis, i, basis, term)
            _add_product(force, row, -1.0, term, state, n_q + i, n_q + column)
            if column != row:
                _add_product(force, column, -1.0, term, state, n_q + i, n_q + row)
                _add_product(force, i, 1.0, term, state, n_q + row, n_q + column)
            else:
                _add_product(force, i, 0.5, term, state, n_q + row, n_q + column)
    _solve_lanes(mass, force)


@inner
def _term(t, coefficient, bases, by, basis, term):
    """Writes term t of a table (lanes,), differentiated by the angle of joint `by` unless that is -1."""
    for k in range(len(term)):
        term[k] = coefficient[t, k]
    for j in range(bases.shape[1]):
        b, factor = bases[t, j], 1.0
        if b == 0:
            continue
        if j == by:  # cos' = -sin, sin' = cos, and twice that for the double angle
            factor = (0.0, -1.0, 1.0, -2.0, 2.0)[b]
            b = (0, 2, 1, 4, 3)[b]
        for k in range(len(term)):
            term[k] *= factor * basis[j, b, k]


@inlined
def _add_product(force, row, factor, term, state, i, j):
    for k in range(len(term)):
        force[row, k] += factor * term[k] * state[i, k] * state[j, k]


@inner
def _solve_lanes(mass, force):
    """Solves mass * a = force in every lane; mass: upper triangle. Both are overwritten."""
    n, lanes = force.shape
    for i in range(n):
        for k in range(lanes):
            mass[i, i, k] = 1.0 / mass[i, i, k]
        for j in range(i + 1, n):
            for c in range(j, n):
                for k in range(lanes):
                    mass[j, c, k] -= mass[i, j, k] * mass[i, i, k] * mass[i, c, k]
            for k in range(lanes):
                force[j, k] -= mass[i, j, k] * mass[i, i, k] * force[i, k]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            for k in range(lanes):
                force[i, k] -= mass[i, j, k] * force[j, k]
        for k in range(lanes):
            force[i, k] *= mass[i, i, k]


@inner
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
