"""CollocationMpc: model predictive control, by a plan that is made anew every few control steps."""

from collections.abc import Callable

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context, EventStatus, LeafSystem, State

from drakearm.model.motion import Motion

REPLANNING_STEP = 0.04  # s, the paper's

Planner = Callable[[float, np.ndarray, Motion | None], Motion]


class CollocationMpc(LeafSystem):
    """Plans from where the arm is at every replanning step and applies the planned torques until the next.

    .. pydrake_system::

        name: CollocationMpc
        input_ports:
        - arm_state
        output_ports:
        - torque
        - predicted_state

    =============== ===== ========== =========================================================
    port            size  unit       meaning
    =============== ===== ========== =========================================================
    arm_state       2 n_q rad, rad/s q and v
    torque          n_q   Nm         of the latest plan, at the present time
    predicted_state       rad, rad/s of the latest plan: q and v, a Trajectory over time (abstract)
    =============== ===== ========== =========================================================

    planner: from the time (s), the arm's state and the plan before (None at first) to the motion from there on;
    `drakearm.planning.RecedingHorizon` is one. What it raises ends the simulation. The first plan is made when the
    simulation is initialized.
    """

    def __init__(self, planner: Planner, n_q: int, replanning_step: float = REPLANNING_STEP):
        super().__init__()
        self._planner = planner
        self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * n_q)
        self._motion = self.DeclareAbstractState(AbstractValue.Make(None))
        self.DeclareVectorOutputPort("torque", n_q, self._torque)
        self.DeclareAbstractOutputPort("predicted_state", lambda: AbstractValue.Make(None), self._predicted_state)
        self.DeclareInitializationUnrestrictedUpdateEvent(self._plan)
        self.DeclarePeriodicUnrestrictedUpdateEvent(replanning_step, replanning_step, self._plan)

    def _plan(self, context: Context, state: State) -> EventStatus:
        before = context.get_abstract_state(int(self._motion)).get_value()
        motion = self._planner(context.get_time(), self._arm_state.Eval(context), before)
        state.get_mutable_abstract_state(int(self._motion)).set_value(motion)
        return EventStatus.Succeeded()

    def _torque(self, context: Context, torque: BasicVector) -> None:
        motion = context.get_abstract_state(int(self._motion)).get_value()
        if motion is not None:  # not initialized yet: no torque
            torque.SetFromVector(motion.inputs.value(context.get_time()).ravel())

    def _predicted_state(self, context: Context, trajectory: AbstractValue) -> None:
        motion = context.get_abstract_state(int(self._motion)).get_value()
        trajectory.set_value(motion and motion.states)
