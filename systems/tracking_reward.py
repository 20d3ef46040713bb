"""TrackingReward: how well the arm follows a reference."""

from typing import Annotated

import numpy as np
from pydantic import ConfigDict, Field
from pydantic.dataclasses import dataclass
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drakearm.model.tracking import tracking_reward

Weights = tuple[Annotated[float, Field(ge=0, allow_inf_nan=False)], ...]


@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class RewardWeights:
    """Weights of eq. 6 of Denizdurduran et al. (2022), one a coordinate."""

    position: Weights  # 1/rad^2
    velocity: Weights  # s^2/rad^2
    acceleration: Weights  # s^4/rad^2

    def array(self) -> np.ndarray:
        """All of them in this order, (3 n_q,)."""
        return np.array([*self.position, *self.velocity, *self.acceleration])


class TrackingReward(LeafSystem):
    """The reward of eq. 6 of Denizdurduran et al. (2022), and the tracking error.

    .. pydrake_system::

        name: TrackingReward
        input_ports:
        - arm_state
        - arm_acceleration
        - reference
        output_ports:
        - reward
        - tracking_error

    ================ ===== ============ ====================================================
    port             size  unit         meaning
    ================ ===== ============ ====================================================
    arm_state        2 n_q rad, rad/s   q and v
    arm_acceleration n_q   rad/s^2
    reference        2 n_q rad, rad/s   wanted q and v
    reward           1     1            0 on the reference at rest, negative otherwise
    tracking_error   n_q   rad          q minus wanted q
    ================ ===== ============ ====================================================
    """

    def __init__(self, weights: RewardWeights):
        super().__init__()
        self._weights = weights.array()
        self._n_q = len(weights.position)
        self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * self._n_q)
        self._acceleration = self.DeclareVectorInputPort("arm_acceleration", self._n_q)
        self._reference = self.DeclareVectorInputPort("reference", 2 * self._n_q)
        states = {self._arm_state.ticket(), self._reference.ticket()}
        self.DeclareVectorOutputPort("reward", 1, self._calc_reward, states | {self._acceleration.ticket()})
        self.DeclareVectorOutputPort("tracking_error", self._n_q, self._calc_error, states)

    def _calc_reward(self, context: Context, output: BasicVector) -> None:
        arm_state, reference = self._arm_state.Eval(context), self._reference.Eval(context)
        output[0] = tracking_reward(arm_state, self._acceleration.Eval(context), reference, self._weights)

    def _calc_error(self, context: Context, output: BasicVector) -> None:
        q = self._arm_state.Eval(context)[: self._n_q]
        output.SetFromVector(q - self._reference.Eval(context)[: self._n_q])
