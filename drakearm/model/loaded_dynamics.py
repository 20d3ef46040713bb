"""The equations of motion of an arm with any load in its hand, without a plant for each load."""

from collections.abc import Sequence

import numpy as np

from drakearm.model.arm import Arm
from drakearm.model.dynamics_table import DynamicsTable, read_dynamics, stack_dynamics
from drakearm.model.torque_arm import MakeTorqueArm

_SAMPLES = (1.0, 8.0)  # kg


class LoadedDynamics:
    """Makes the tables of arms that differ in their loads.

    Every coefficient of a table is linear in the mass of the load and in its moment of inertia. The load is a ball of
    iron, so its moment of inertia is proportional to mass^(5/3). Hence the tables for no load and for two loads give
    the one for any load.
    """

    def __init__(self, arms: Sequence[Arm]):
        """arms: A arms with the same number of joints."""
        plants = [MakeTorqueArm(arm, mass) for arm in arms for mass in (0.0, *_SAMPLES)]
        self._table = stack_dynamics([read_dynamics(plant) for plant in plants])
        self._mass, self._gravity = (
            np.stack([_by_load(samples) for samples in coefficients.reshape(len(arms), len(_SAMPLES) + 1, -1)])
            for coefficients in (self._table.mass_coefficient, self._table.gravity_coefficient)
        )

    def stacked(self, arm: np.ndarray, load_mass: np.ndarray) -> DynamicsTable:
        """The table of N skeletons, as `stack_dynamics` makes it. All tables of this object have the same terms.

        arm: (N,), the index of each skeleton's arm. load_mass: (N,), kg.
        """
        # Python's power gives the same bits on every processor, NumPy's does not.
        loads = np.array([(1.0, mass, mass ** (5.0 / 3.0)) for mass in load_mass.tolist()]).reshape(-1, 3)
        return self._table._replace(
            mass_coefficient=_weighted(loads, self._mass[arm]), gravity_coefficient=_weighted(loads, self._gravity[arm])
        )


def _weighted(loads: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """The coefficients (N K,) of N skeletons. A sum in fixed order: matrix products depend on the memory's addresses.

    loads: (N, 3), what the coefficients are linear in. factors: (N, 3, K).
    """
    empty, mass, inertia = (loads[:, k, None] * factors[:, k] for k in range(3))
    return (empty + mass + inertia).ravel()


def _by_load(samples: np.ndarray) -> np.ndarray:
    """The factors (3, K) of 1, mass and mass^(5/3) in the coefficients, from those (3, K) of `_SAMPLES` and no load."""
    empty = samples[0]
    added = (samples[1:] - empty) / np.array(_SAMPLES)[:, None]
    inertia = (added[1] - added[0]) / (_SAMPLES[1] ** (2.0 / 3.0) - _SAMPLES[0] ** (2.0 / 3.0))
    return np.stack([empty, added[0] - _SAMPLES[0] ** (2.0 / 3.0) * inertia, inertia])
