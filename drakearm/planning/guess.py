"""The minimum-jerk movement with the torques it takes: where the optimization starts."""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model import skeleton


def minimum_jerk(start: np.ndarray, target: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, v, a, each (N, n_q), of the smoothest movement from rest to rest, at times (N,).

    Flash and Hogan 1985, for each joint angle.
    """
    duration = times[-1] - times[0]
    s = ((times - times[0]) / duration)[:, None]
    way = target - start
    q = start + way * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    v = way / duration * 30.0 * s**2 * (1.0 - s) ** 2
    a = way / duration**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)
    return q, v, a


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
