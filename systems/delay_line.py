"""DelayLine: what a vector was some steps ago, as a nerve reports it."""

import numpy as np
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem


class DelayLine(LeafSystem):
    """Delays a vector by a whole number of steps, and keeps all its values since then.

    .. pydrake_system::

        name: DelayLine
        input_ports:
        - u
        output_ports:
        - delayed_u
        - past_u

    ========= ============ ===================================================================
    port      size         meaning
    ========= ============ ===================================================================
    u         size
    delayed_u size         what u was `SetSteps` steps ago, by default the longest delay
    past_u    size longest what u was one, two, ... steps ago, one value after the other
    ========= ============ ===================================================================

    step: s. longest: the longest delay in steps, at least 1. size: of the input. empty: whether the line holds zeros at
    the start of a run, and not what the input is then. Controllers decide before discrete states change at the same
    instant. So what a controller gets is from the beginning of an earlier step.
    """

    def __init__(self, step: float, longest: int, size: int, *, empty: bool = False):
        super().__init__()
        self._size, self._longest, self._empty = size, longest, empty
        self._u = self.DeclareVectorInputPort("u", size)
        past = self.DeclareDiscreteState(size * longest)
        self._steps = self.DeclareNumericParameter(BasicVector([longest]))
        self.DeclareVectorOutputPort("delayed_u", size, self._calc_delayed)
        self.DeclareStateOutputPort("past_u", past)
        self.DeclarePeriodicDiscreteUpdateEvent(step, 0.0, self._shift)

    def SetSteps(self, root_context: Context, steps: int) -> None:
        """Sets the delay, from 0 to the longest one."""
        context = self.GetMyMutableContextFromRoot(root_context)
        context.get_mutable_numeric_parameter(self._steps).SetAtIndex(0, steps)

    def Begin(self, root_context: Context, rng: np.random.Generator | None = None) -> None:
        """Prepares the line for a run. Call it when all other systems have their start state."""
        context = self.GetMyMutableContextFromRoot(root_context)
        start = np.zeros(self._size) if self._empty else self._u.Eval(context)
        context.SetDiscreteState(np.tile(start, self._longest))

    def _shift(self, context: Context, state: DiscreteValues) -> None:
        past = context.get_discrete_state_vector().value()
        state.set_value(np.concatenate([self._u.Eval(context), past[: -self._size]]))

    def _calc_delayed(self, context: Context, output: BasicVector) -> None:
        steps = int(context.get_numeric_parameter(self._steps).GetAtIndex(0))
        if steps == 0:
            output.SetFromVector(self._u.Eval(context))
        else:
            past = context.get_discrete_state_vector().value()
            output.SetFromVector(past[(steps - 1) * self._size : steps * self._size])
