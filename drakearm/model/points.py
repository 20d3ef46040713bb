"""The positions of points of the skeleton, compiled: a table that is derived from a MultibodyPlant, like the dynamics.

The position of a point on a tree of revolute joints is a trigonometric polynomial of degree 1 in each joint angle.
Samples of the plant at three angles per joint therefore give its coefficients exactly.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.errors import ArmError
from drakearm.model.interpolation import coefficients, sample_points, terms
from drakearm.muscle.compiled import compiled

_DEGREE = 1


class PointTable(NamedTuple):
    """Terms of the positions of P points: coefficient * product over the joints j of 1, cos q_j or sin q_j.

    basis has the factor of each joint: 0 for 1, 1 for cos q_j, 2 for sin q_j.
    """

    basis: np.ndarray  # (K, n_q)
    coefficient: np.ndarray  # (K, P, 3), m


def read_points(plant: MultibodyPlant, points: Sequence[tuple[str, Sequence[float]]]) -> PointTable:
    """The table of points on a finalized plant that is a tree of revolute joints.

    points: for each its frame's name and its position in that frame, p_FP, m. Raises ArmError for a plant of another
    kind, and for a frame that the plant does not have.
    """
    for frame, _ in points:
        if not plant.HasFrameNamed(frame):
            raise ArmError(f"A point is given in the frame {frame}: expected a frame of the skeleton.")
    n_q = plant.num_positions()
    context = plant.CreateDefaultContext()

    def positions(q: np.ndarray) -> np.ndarray:
        plant.SetPositions(context, q)
        return np.array([plant.GetFrameByName(f).CalcPoseInWorld(context).multiply(np.array(p)) for f, p in points])

    sampled = np.array([positions(q) for q in sample_points(_DEGREE, n_q)])
    table = PointTable(terms(_DEGREE, n_q), coefficients(sampled, _DEGREE, n_q))
    between = np.full(n_q, 0.7)  # not a sample point: only a tree of revolute joints agrees here too
    if not np.allclose(point_positions(between, table)[0], positions(between), atol=1e-9):
        raise ArmError("The skeleton cannot be compiled: expected a tree of revolute joints.")
    return table


@compiled
def point_positions(q, points):
    """Positions p_WP (P, 3), m, of the points at joint angles q, and their derivatives by q (P, 3, n_q), m/rad."""
    n_q = len(q)
    n_points = points.coefficient.shape[1]
    position = np.zeros((n_points, 3))
    jacobian = np.zeros((n_points, 3, n_q))
    for k in range(len(points.basis)):
        basis = points.basis[k]
        for i in range(-1, n_q):  # -1: the value; i: the derivative by q_i
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
