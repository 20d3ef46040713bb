"""The arm with path functions of two coordinates together, for tests of what must hold for every kind of path."""

from dataclasses import replace

import numpy as np

from drakearm.model import Arm, TensorTerm


def with_tensor_paths(arm: Arm, coupling: float = 0.0) -> Arm:
    """The arm whose muscles of two joints have one term of both coordinates.

    Their lengths are those of the arm, plus waves in both angles with an amplitude of `coupling`, m.
    """
    muscles = []
    for muscle in arm.muscles:
        if len(muscle.path) == 2:
            one, two = muscle.path
            sums = np.add.outer(one.coefficients, two.coefficients)  # the B-splines of a coordinate sum to 1
            waves = np.outer(*(np.sin(np.arange(n)) for n in sums.shape))
            table = (sums + coupling * waves).tolist()
            muscle = replace(
                muscle, path=(TensorTerm((one.coordinate, two.coordinate), (one.knots, two.knots), table),)
            )
        muscles.append(muscle)
    return replace(arm, muscles=tuple(muscles))
