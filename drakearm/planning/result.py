"""What planning returns: the reference, how it was found and how far it can be trusted."""

from dataclasses import dataclass

import numpy as np

from drakearm.model.reference import Reference
from drakearm.planning.verification import Verification


@dataclass(frozen=True)
class Plan:
    """An optimal movement: its reference, how it was found, and its knots (N of them)."""

    reference: Reference
    solver: str
    status: str
    iterations: int  # of the solver; SNOPT tells evaluations of the problem instead
    seconds: float  # to plan, all in all
    costs: dict[str, float]  # what each type of cost contributes
    verification: Verification
    t: np.ndarray  # (N,) s
    q: np.ndarray  # (N, n_q) rad
    v: np.ndarray  # (N, n_q) rad/s
    tau: np.ndarray  # (N, n_q) Nm, linear between the knots
