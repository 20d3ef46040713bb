"""The skeleton's equations of motion as a table, derived from a MultibodyPlant and not written a second time.

The mass matrix and the gravity torques of a tree of revolute joints are trigonometric polynomials of degree 2 in each
joint angle. Samples of the plant at five angles per joint therefore give their coefficients exactly, loads included.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from drakearm.errors import ArmError
from drakearm.model.interpolation import coefficients, sample_points, terms

_DEGREE = 2
_NEGLIGIBLE = 1e-14  # of the largest coefficient


class DynamicsTable(NamedTuple):
    """Terms of the mass matrix and of the gravity torques, and in which order to compute them.

    A term is a coefficient times one factor per joint j: 1, cos q_j, sin q_j, cos 2 q_j or sin 2 q_j, which the basis
    numbers from 0 to 4. There are K terms of the mass matrix M and G of the gravity torques; terms whose coefficient is
    0 are left out. Tables of several skeletons can be combined, see `stack_dynamics`.

    - mass_entry (K, 2): row and column of M to which the term belongs, row <= column
    - mass_basis (K, n_q): the term's factor of each joint
    - mass_coefficient (K,): kg m^2; for N skeletons (N K,), one skeleton after the other
    - gravity_entry (G,): joint to whose torque the term belongs
    - gravity_basis (G, n_q): the term's factor of each joint
    - gravity_coefficient (G,): Nm; for N skeletons (N G,), one skeleton after the other
    - mass_product (K,): row of products that holds the term without its coefficient
    - gravity_product (G,): the same for the terms of the gravity torques
    - factors (P, 2): the two rows of products whose product is row 1 + 4 n_q + p
    - slope_entry (S, 3): row and column of M, and the joint by whose angle this entry of M is differentiated
    - slope_term (D, 4): row of slope_entry to which it belongs, term of M that is differentiated, row of products that
      holds the term's derivative, and the integer (-2, -1, 1 or 2) by which this row is multiplied

    `forward_dynamics_lanes` computes the products row by row: row 0 is 1; rows 1 + 4 j to 4 + 4 j are cos q_j, sin q_j,
    cos 2 q_j and sin 2 q_j; then one row for each of the factors. Terms that have the same product share its row.

    An example: a planar double pendulum that hangs down, with 1 kg at the ends of two massless links of 1 m and gravity
    of 10 m/s^2. With q_0 of the first link from the vertical and q_1 between the links, its equations of motion have

        M = [[3 + 2 cos q_1, 1 + cos q_1], [1 + cos q_1, 1]]
        gravity torques = [-20 sin q_0 - 10 sin(q_0 + q_1), -10 sin(q_0 + q_1)]

    and sin(q_0 + q_1) = cos q_0 sin q_1 + sin q_0 cos q_1. The table is

        mass_entry           [[0, 0], [0, 1], [1, 1], [0, 0], [0, 1]]
        mass_basis           [[0, 0], [0, 0], [0, 0], [0, 1], [0, 1]]
        mass_coefficient     [3, 1, 1, 2, 1]
        gravity_entry        [0, 1, 0, 0, 1]
        gravity_basis        [[1, 2], [1, 2], [2, 0], [2, 1], [2, 1]]
        gravity_coefficient  [-10, -10, -20, -10, -10]
        mass_product         [0, 0, 0, 5, 5]       1 and cos q_1
        gravity_product      [9, 9, 2, 10, 10]     row 2 is sin q_0
        factors              [[1, 6], [2, 5]]      row 9 is cos q_0 sin q_1, row 10 is sin q_0 cos q_1
        slope_entry          [[0, 0, 1], [0, 1, 1]]
        slope_term           [[0, 3, 6, -1], [1, 4, 6, -1]]

    The last line says that dM_00/dq_1 is term 3 differentiated: its coefficient 2 times row 6, sin q_1, times -1; and
    dM_01/dq_1 is term 4 differentiated.
    """

    mass_entry: np.ndarray
    mass_basis: np.ndarray
    mass_coefficient: np.ndarray
    gravity_entry: np.ndarray
    gravity_basis: np.ndarray
    gravity_coefficient: np.ndarray
    mass_product: np.ndarray
    gravity_product: np.ndarray
    factors: np.ndarray
    slope_entry: np.ndarray
    slope_term: np.ndarray


def read_dynamics(plant: MultibodyPlant) -> DynamicsTable:
    """The table of a finalized plant that is a tree of revolute joints. Raises ArmError for any other plant."""
    n_q = plant.num_positions()
    context = plant.CreateDefaultContext()
    mass, gravity = [], []
    for q in sample_points(_DEGREE, n_q):
        plant.SetPositions(context, q)
        mass.append(plant.CalcMassMatrix(context))
        gravity.append(plant.CalcGravityGeneralizedForces(context))
    rows, columns = np.triu_indices(n_q)
    bases = terms(_DEGREE, n_q)
    mass_terms = coefficients(np.array(mass)[:, rows, columns], _DEGREE, n_q)
    gravity_terms = coefficients(np.array(gravity), _DEGREE, n_q)
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
    """One table of N skeletons with the same number of joints: every term that any of them has, 0 where one lacks it.

    Its arrays have the types of a table of one skeleton, so Numba compiles the functions that take it only once.
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
    """The table with these terms. Terms and slopes that have the same product share one row of products."""
    n_q = mass_basis.shape[1]
    factors: list[tuple[int, int]] = []
    made: dict[tuple[int, ...], int] = {}

    def product(basis: tuple[int, ...]) -> int:
        """The row of a product, which is made from the product of all its factors but the last."""
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
            if function:  # cos' = -sin and sin' = cos; twice as much for the double angle
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
    """Compares with the plant between the sample points, where only a tree of revolute joints agrees."""
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
        share = c / 2 if row == column else c  # added twice, at row and at column
        derivative = share * np.array([functions[(joints == i).astype(int), joints, basis].prod() for i in joints])
        mass[[row, column], [column, row]] += share * functions[0, joints, basis].prod() * (1 + (row == column))
        force[row] -= derivative @ v * v[column]
        force[column] -= derivative @ v * v[row]
        force += derivative * v[row] * v[column]
    if not np.allclose(np.linalg.solve(mass, force), expected, rtol=1e-6, atol=1e-6):
        raise ArmError("The skeleton cannot be compiled: expected a tree of revolute joints.")


def _basis(q: np.ndarray) -> np.ndarray:
    """The five factors (..., 5) of angles (...)."""
    return np.stack([np.ones_like(q), np.cos(q), np.sin(q), np.cos(2 * q), np.sin(2 * q)], axis=-1)


def _slopes(q: np.ndarray) -> np.ndarray:
    """The derivatives of the five factors (..., 5)."""
    return np.stack([np.zeros_like(q), -np.sin(q), np.cos(q), -2 * np.sin(2 * q), 2 * np.cos(2 * q)], axis=-1)
