"""CollocationMpc: model predictive control that makes a new plan every few control steps."""

from collections.abc import Callable

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context, EventStatus, LeafSystem, State
from pydrake.trajectories import PiecewisePolynomial

from drakearm.model.motion import Motion

REPLANNING_STEP = 0.04  # s, as in Denizdurduran et al. 2022

Planner = Callable[[float, np.ndarray, Motion | None], Motion]


class CollocationMpc(LeafSystem):
    """Plans from the present state of the arm at every replanning step, and applies the planned torques until the next.

    .. pydrake_system::

        name: CollocationMpc
        input_ports:
        - arm_state
        output_ports:
        - torque
        - predicted_state

    =============== ===== ========== ======================================================================
    port            size  unit       meaning
    =============== ===== ========== ======================================================================
    arm_state       2 n_q rad, rad/s q and v
    torque          n_q   Nm         of the latest plan, at the present time; zero before the first plan
    predicted_state       rad, rad/s of the latest plan: q and v over time, a PiecewisePolynomial (abstract)
    =============== ===== ========== ======================================================================

    The first plan is made when the simulation is initialized. Before that, the trajectory of `predicted_state` has no
    segments.

    planner: a function that plans the motion from the present on, such as `drakearm.planning.RecedingHorizon`. Its
    arguments are the time (s), the arm's state (2 n_q,) and the previous plan (None at first). An exception of the
    planner ends the simulation.
    """

    def __init__(self, planner: Planner, n_q: int, replanning_step: float = REPLANNING_STEP):
        super().__init__()
        self._planner = planner
        self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * n_q)
        self._motion = self.DeclareAbstractState(AbstractValue.Make(_unplanned()))
        self.DeclareVectorOutputPort("torque", n_q, self._torque)
        self.DeclareAbstractOutputPort(
            "predicted_state", lambda: AbstractValue.Make(PiecewisePolynomial()), self._predicted_state
        )
        self.DeclareInitializationUnrestrictedUpdateEvent(self._plan)
        self.DeclarePeriodicUnrestrictedUpdateEvent(replanning_step, replanning_step, self._plan)

    def _plan(self, context: Context, state: State) -> EventStatus:
        previous = self._planned(context)
        motion = self._planner(context.get_time(), self._arm_state.Eval(context), previous)
        state.get_mutable_abstract_state(int(self._motion)).set_value(motion)
        return EventStatus.Succeeded()

    def _torque(self, context: Context, torque: BasicVector) -> None:
        motion = self._planned(context)
        if motion is None:
            torque.SetZero()
        else:
            torque.SetFromVector(motion.inputs.value(context.get_time()).ravel())

    def _predicted_state(self, context: Context, trajectory: AbstractValue) -> None:
        trajectory.set_value(context.get_abstract_state(int(self._motion)).get_value().states)

    def _planned(self, context: Context) -> Motion | None:
        """The latest plan; None before the first one."""
        motion = context.get_abstract_state(int(self._motion)).get_value()
        return motion if motion.states.get_number_of_segments() else None


def _unplanned() -> Motion:
    """What the state holds before the first plan: Drake's abstract values cannot hold None."""
    return Motion(states=PiecewisePolynomial(), inputs=PiecewisePolynomial())
