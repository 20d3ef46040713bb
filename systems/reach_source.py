"""ReachSource: plans a new reference whenever its target changes."""

from collections.abc import Callable

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, EventStatus, State

from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.systems.reference_source import ReferenceSource

# From q, v (n_q,) of the arm, a target and the desired acceleration (n_q,) to the reference that begins there.
Planner = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], Reference]


class ReachSource(ReferenceSource):
    """A ReferenceSource that plans: at every control step at which its target has changed.

    .. pydrake_system::

        name: ReachSource
        input_ports:
        - target
        - arm_state
        output_ports:
        - reference
        - preview_q
        - preview_v

    ========= ========= ========== ===============================================================
    port      size      unit       meaning
    ========= ========= ========== ===============================================================
    target    n_target  as planner where to go: what the planner takes
    arm_state 2 n_q     rad, rad/s q and v, from which the reference begins
    ========= ========= ========== ===============================================================

    The outputs are those of `ReferenceSource`. planner: see `Planner`; what it raises ends the simulation. n_target:
    size of the target. first: the reference before the first change of the target. target: the one that the first
    reference has reached. A new reference begins where the old one is at this time, unless the arm has strayed from it
    by more than `strayed`: then it begins at the state of the arm. So a target can change in the middle of a movement.
    """

    def __init__(
        self,
        planner: Planner,
        first: Reference,
        target: np.ndarray,
        lookahead: tuple[int, ...],
        strayed: float = 0.05,
    ):
        super().__init__(first, lookahead)
        self._planner, self._strayed = planner, strayed
        self._target = self.DeclareVectorInputPort("target", len(target))
        self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * self._n_q)
        self._latest = self.DeclareAbstractState(AbstractValue.Make(np.array(target, dtype=float)))
        self.DeclarePeriodicUnrestrictedUpdateEvent(CONTROL_STEP, 0.0, self._plan)

    def _plan(self, context: Context, state: State) -> EventStatus:
        target = self._target.Eval(context)
        if np.array_equal(target, context.get_abstract_state(self._latest).get_value()):
            return EventStatus.DidNothing()
        time, course = context.get_time(), self._get_course(context)
        desired = course.reference
        step = min(round((time - course.begin) / CONTROL_STEP), len(desired.t) - 1)
        q, v, a = desired.q[step], desired.v[step], desired.a[step]
        actual_q, actual_v = np.split(self._arm_state.Eval(context), 2)
        if np.abs(actual_q - q).max() > self._strayed:
            q, v, a = actual_q, actual_v, np.zeros(self._n_q)
        reference = self._planner(q, v, target.copy(), a)
        state.get_mutable_abstract_state(self._course).set_value(self._make_course(reference, time))
        state.get_mutable_abstract_state(self._latest).set_value(target.copy())
        return EventStatus.Succeeded()
