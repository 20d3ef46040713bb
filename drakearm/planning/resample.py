"""From the knots of a plan to a reference at control steps."""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.trajectories import PiecewisePolynomial

from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.planning.torques import gravity_torque


def make_reference(
    plant: MultibodyPlant, states: PiecewisePolynomial, inputs: PiecewisePolynomial, hold: float
) -> Reference:
    """The trajectories of (q, v) and tau at control steps, then `hold` seconds at rest.

    The accelerations are the plant's for the sampled q, v and tau, not derivatives of the spline:
    so every sample satisfies the equations of motion, and inverse dynamics gives back its tau.
    """
    steps = round(states.end_time() / CONTROL_STEP)
    rest = round(hold / CONTROL_STEP)
    times = np.minimum(CONTROL_STEP * np.arange(steps + 1), states.end_time())
    q, v = np.split(states.vector_values(times).T, 2, axis=1)
    tau = inputs.vector_values(times).T
    a = _accelerations(plant, q, v, tau)
    still = np.zeros((rest, q.shape[1]))
    return Reference(
        t=CONTROL_STEP * np.arange(steps + rest + 1),
        q=np.vstack([q, still + q[-1]]),
        v=np.vstack([v, still]),
        a=np.vstack([a, still]),
        tau=np.vstack([tau, still + gravity_torque(plant, q[-1])]),
    )


def _accelerations(plant: MultibodyPlant, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
    context = plant.CreateDefaultContext()
    actuation = plant.get_actuation_input_port()
    a = np.empty_like(v)
    for k in range(len(q)):
        plant.SetPositionsAndVelocities(context, np.concatenate([q[k], v[k]]))
        actuation.FixValue(context, tau[k])
        a[k] = plant.EvalTimeDerivatives(context).CopyToVector()[q.shape[1] :]
    return a
