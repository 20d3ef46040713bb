"""The skeleton's equations of motion as a table, read off a MultibodyPlant and not written beside it.

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

_ANGLES = 2.0 * np.pi / 5.0 * np.arange(5)
_NEGLIGIBLE = 1e-14  # of the largest coefficient


class DynamicsTable(NamedTuple):
    """Terms of the mass matrix and of the gravity torques; those with coefficient 0 are left out.

    A term is coefficient * product over the joints j of the function basis[j] of q_j: 1, cos, sin, cos of the double,
    sin of the double angle. mass_entry: row and column of the mass matrix, row <= column. gravity_entry: the
    coordinate. Coefficients of N skeletons follow each other, (N K,) and (N G,), see `stack_dynamics`.

    The other fields say how `forward_dynamics_lanes` computes: from rows of products, of which the first is 1, the next
    ones are the four functions of every joint angle, and each further one is the product of two `factors`. Row and
    column of the mass matrix and a joint that it depends on make a slope, which has terms of its own: slope, mass term
    and product, and the integer that the coefficient of the mass term is multiplied by.
    """

    mass_entry: np.ndarray  # (K, 2)
    mass_basis: np.ndarray  # (K, n_q)
    mass_coefficient: np.ndarray  # (K,)
    gravity_entry: np.ndarray  # (G,)
    gravity_basis: np.ndarray  # (G, n_q)
    gravity_coefficient: np.ndarray  # (G,)
    mass_product: np.ndarray  # (K,), rows of products
    gravity_product: np.ndarray  # (G,), rows of products
    factors: np.ndarray  # (P, 2), rows of products
    slope_entry: np.ndarray  # (S, 3), row and column of the mass matrix, joint
    slope_term: np.ndarray  # (D, 4)


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
    table = _make_table(
        np.stack([rows[entry], columns[entry]], axis=1),
        bases[m],
        mass_terms[m, entry],
        coordinate,
        bases[g],
        gravity_terms[g, coordinate],
    )
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
    return _make_table(*stack(*columns[:3]), *stack(*columns[3:6]))


def _make_table(
    mass_entry: np.ndarray,
    mass_basis: np.ndarray,
    mass_coefficient: np.ndarray,
    gravity_entry: np.ndarray,
    gravity_basis: np.ndarray,
    gravity_coefficient: np.ndarray,
) -> DynamicsTable:
    """The table with these terms. Its products are made once, however many terms and slopes share them."""
    n_q = mass_basis.shape[1]
    factors: list[tuple[int, int]] = []
    made: dict[tuple[int, ...], int] = {}

    def product(basis: tuple[int, ...]) -> int:
        joints = [j for j in range(n_q) if basis[j]]
        if not joints:
            return 0
        last = joints[-1]
        function = 4 * last + basis[last]
        if len(joints) == 1:
            return function
        if basis not in made:
            factors.append((product((*basis[:last], *[0] * (n_q - last))), function))
            made[basis] = 4 * n_q + len(factors)
        return made[basis]

    slopes: dict[tuple[int, int, int], int] = {}
    slope_terms = []
    for t, ((row, column), basis) in enumerate(zip(mass_entry.tolist(), mass_basis.tolist(), strict=True)):
        for j, function in enumerate(basis):
            if function:  # cos' = -sin, sin' = cos, and twice that for the double angle
                slope = slopes.setdefault((row, column, j), len(slopes))
                turned = (*basis[:j], (0, 2, 1, 4, 3)[function], *basis[j + 1 :])
                slope_terms.append((slope, t, product(turned), (0, -1, 1, -2, 2)[function]))
    arrays = (
        mass_entry,
        mass_basis,
        mass_coefficient,
        gravity_entry,
        gravity_basis,
        gravity_coefficient,
        np.array([product(tuple(basis)) for basis in mass_basis.tolist()], dtype=np.int64),
        np.array([product(tuple(basis)) for basis in gravity_basis.tolist()], dtype=np.int64),
        np.array(factors, dtype=np.int64).reshape(-1, 2),
        np.array(list(slopes), dtype=np.int64).reshape(-1, 3),
        np.array(slope_terms, dtype=np.int64).reshape(-1, 4),
    )
    return DynamicsTable(*(np.ascontiguousarray(array) for array in arrays))


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
