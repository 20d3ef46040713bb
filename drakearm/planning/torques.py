"""The joint torques that movements and postures take, from the plant's inverse dynamics."""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model import skeleton


def inverse_dynamics(plant: MultibodyPlant, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """The joint torques (N, n_q), Nm, of a movement: q, v, a, each (N, n_q)."""
    context = plant.CreateDefaultContext()
    torques = np.empty_like(q)
    for k in range(len(q)):
        plant.SetPositions(context, q[k])
        plant.SetVelocities(context, v[k])
        torques[k] = skeleton.inverse_dynamics(plant, context, a[k])
    return torques


def gravity_torque(plant: MultibodyPlant, q: np.ndarray) -> np.ndarray:
    """The joint torques (n_q,), Nm, that hold the arm still at q (n_q,)."""
    rest = np.zeros((1, len(q)))
    return inverse_dynamics(plant, q[None, :], rest, rest)[0]
