"""Where points of the skeleton are, compiled: read off a MultibodyPlant, as its dynamics are.

The position of a point on a chain of revolute joints is a trigonometric polynomial of degree 1 in each joint angle, so
a plant that is sampled at three angles a joint gives its coefficients exactly.
"""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.errors import ArmError
from drakearm.muscle.compiled import compiled

_ANGLES = 2.0 * np.pi / 3.0 * np.arange(3)


class PointTable(NamedTuple):
    """Terms of the positions of P points: coefficient * product over the joints j of 1, cos q_j or sin q_j."""

    basis: np.ndarray  # (K, n_q)
    coefficient: np.ndarray  # (K, P, 3), m


def read_points(plant: MultibodyPlant, points: Sequence[tuple[str, Sequence[float]]]) -> PointTable:
    """The table of points (frame, position p_FP in it, m) of a finalized plant that is a chain of revolute joints.

    Raises ArmError for any other plant, and for a frame that it does not have.
    """
    for frame, _ in points:
        if not plant.HasFrameNamed(frame):
            raise ArmError(f"There is no frame {frame} in the skeleton, which a point of it names.")
    n_q = plant.num_positions()
    context = plant.CreateDefaultContext()
    grid = np.array(list(product(_ANGLES, repeat=n_q)))

    def positions(q: np.ndarray) -> np.ndarray:
        plant.SetPositions(context, q)
        return np.array([plant.GetFrameByName(f).CalcPoseInWorld(context).multiply(np.array(p)) for f, p in points])

    bases = np.array(list(product(range(3), repeat=n_q)))
    functions = np.stack([np.ones_like(grid), np.cos(grid), np.sin(grid)], axis=-1)
    design = np.prod([functions[:, j][:, bases[:, j]] for j in range(n_q)], axis=0)
    sampled = np.array([positions(q) for q in grid])
    coefficient = np.linalg.solve(design, sampled.reshape(len(grid), -1)).reshape(len(grid), len(points), 3)
    table = PointTable(bases, np.ascontiguousarray(coefficient))
    off_grid = np.full(n_q, 0.7)
    if not np.allclose(point_positions(off_grid, table)[0], positions(off_grid), atol=1e-9):
        raise ArmError("The skeleton cannot be compiled: expected a chain of revolute joints.")
    return table


@compiled
def point_positions(q, points):
    """Positions p_WP (P, 3), m, of the points at joint angles q, and their derivatives by q (P, 3, n_q)."""
    n_q = len(q)
    n_points = points.coefficient.shape[1]
    position = np.zeros((n_points, 3))
    jacobian = np.zeros((n_points, 3, n_q))
    for k in range(len(points.basis)):
        basis = points.basis[k]
        for i in range(-1, n_q):  # the value, then the derivative by each joint angle
            term = 1.0
            for j in range(n_q):
                if basis[j] == 0:
                    term *= 0.0 if i == j else 1.0
                elif basis[j] == 1:
                    term *= -np.sin(q[j]) if i == j else np.cos(q[j])
                else:
                    term *= np.cos(q[j]) if i == j else np.sin(q[j])
            for p in range(n_points):
                for axis in range(3):
                    if i < 0:
                        position[p, axis] += term * points.coefficient[k, p, axis]
                    else:
                        jacobian[p, axis, i] += term * points.coefficient[k, p, axis]
    return position, jacobian
