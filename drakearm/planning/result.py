"""The result of planning: a reference at control steps, how it was found and how far it can be trusted."""

from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model.motion import Motion
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.model.skeleton import gravity_torque
from drakearm.planning.verification import Verification


@dataclass(frozen=True)
class Plan:
    """An optimal movement: its reference, how it was found, and its N knots."""

    reference: Reference
    solver: str
    status: str
    iterations: int  # of the solver; for SNOPT the number of evaluations of the problem
    seconds: float  # that planning took in all, without the compilation of functions
    costs: dict[str, float]  # contribution of each type of cost
    verification: Verification
    t: np.ndarray  # (N,) s
    q: np.ndarray  # (N, n_q) rad
    v: np.ndarray  # (N, n_q) rad/s
    tau: np.ndarray  # (N, n_q) Nm, linear between the knots


def make_reference(plant: MultibodyPlant, motion: Motion, hold: float) -> Reference:
    """A motion sampled at control steps, then `hold` seconds at rest.

    The accelerations are those that the plant has with the sampled q, v and tau, not derivatives of the spline. So
    every sample satisfies the equations of motion, and inverse dynamics returns its tau.
    """
    end = motion.states.end_time()
    steps, rest = round(end / CONTROL_STEP), round(hold / CONTROL_STEP)
    times = np.minimum(CONTROL_STEP * np.arange(steps + 1), end)
    q, v = np.split(motion.states.vector_values(times).T, 2, axis=1)
    tau = motion.inputs.vector_values(times).T
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
