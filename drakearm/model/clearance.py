"""How far the parts of an arm are from an obstacle, compiled, with derivatives."""

import numpy as np
import scipy
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model.arm import Arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.points import point_positions, read_points
from drakearm.muscle.compiled import compiled

_DENSE = 1e-3  # s, between the times at which the clearance of a movement is measured


class Clearance:
    """The distances of the parts of an arm's outline from an obstacle."""

    def __init__(self, plant: MultibodyPlant, arm: Arm, obstacle: Obstacle):
        """plant: a finalized one with the arm's skeleton. Raises ArmError if it cannot be compiled (`read_points`)."""
        self._ends = read_points(plant, [end for capsule in arm.outline for end in capsule.ends])
        self._radii = np.array([capsule.radius for capsule in arm.outline]) + obstacle.radius
        self._axis = np.array(obstacle.position), obstacle.direction

    def __call__(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The distances (c,), m, of the parts at joint angles q (n_q,), rad, and their derivatives by q (c, n_q).

        A distance is negative if the part is inside the obstacle.
        """
        return clearances(q, self._ends, self._radii, *self._axis)

    def along(self, t: np.ndarray, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Times (n,), s, 1 ms apart, and the distances (n, c), m, of the parts in a movement then.

        t: (N,), s. q, v: (N, n_q), rad and rad/s. Between these samples the joints follow the cubic curves of their
        angles and speeds.
        """
        times = np.linspace(t[0], t[-1], round((t[-1] - t[0]) / _DENSE) + 1)
        return times, np.array([self(posture)[0] for posture in scipy.interpolate.CubicHermiteSpline(t, q, v)(times)])


@compiled
def clearances(q, ends, radii, center, direction):
    """Distances (c,), m, of c capsules from an infinitely long cylinder, and their derivatives by q (c, n_q).

    ends: table of the 2 c ends of the capsules' axes. radii: (c,), m, the radius of each capsule plus that of the
    cylinder. center, direction: a point on the cylinder's axis, m, and its unit vector, (3,) each. A distance is
    negative where the two overlap: then it is how far they would have to move apart, with a minus sign.

    Seen along the cylinder, its axis is a point and the capsule's axis is a line from a to b. The nearest point of that
    line is a + s (b - a). The derivatives treat s as constant: within the line the distance is a minimum over s, and at
    its ends s does not change.
    """
    position, jacobian = point_positions(q, ends)
    distance = np.empty(len(radii))
    derivative = np.zeros((len(radii), len(q)))
    for c in range(len(radii)):
        a, b = position[2 * c] - center, position[2 * c + 1] - center
        a, b = a - (a @ direction) * direction, b - (b @ direction) * direction
        way = b - a
        squared = way @ way
        s = min(max(-(a @ way) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
        nearest = a + s * way
        gap = np.sqrt(nearest @ nearest)
        distance[c] = gap - radii[c]
        if gap > 0.0:  # on the cylinder's axis there is no derivative: 0
            for j in range(len(q)):
                move = (1.0 - s) * jacobian[2 * c, :, j] + s * jacobian[2 * c + 1, :, j]
                derivative[c, j] = (nearest / gap) @ move
    return distance, derivative
