"""How far capsules on the arm are from a cylinder, compiled, with derivatives."""

import numpy as np

from drakearm.model.points import point_positions
from drakearm.muscle.compiled import compiled


@compiled
def clearances(q, ends, radii, center, direction):
    """Distances (c,), m, between c capsules and a cylinder without ends, and their derivatives by q (c, n_q).

    ends: table of the 2 c ends of the capsules' axes. radii: (c,), the capsule's plus the cylinder's. center,
    direction: of the cylinder's axis, (3,) each. Negative where they overlap, by as much as would part them.

    Seen along the cylinder, its axis is a point and a capsule's axis a segment a-b. The nearest point of the segment
    moves along it to first order only where that does not change the distance, so its share of the way, s, counts as
    constant.
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
        if gap > 0.0:  # on the axis any way out is as short
            for j in range(len(q)):
                move = (1.0 - s) * jacobian[2 * c, :, j] + s * jacobian[2 * c + 1, :, j]
                derivative[c, j] = (nearest / gap) @ move
    return distance, derivative
