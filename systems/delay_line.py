"""DelayLine: delays a vector by a whole number of steps, as a nerve does."""

import numpy as np
from pydrake.systems.framework import Context
from pydrake.systems.primitives import DiscreteTimeDelay


class DelayLine(DiscreteTimeDelay):
    """Drake's DiscreteTimeDelay, which begins with what its input is at the start of a run instead of zeros.

    .. pydrake_system::

        name: DelayLine
        input_ports:
        - u
        output_ports:
        - delayed_u

    step: s. steps: a controller that decides every `step` gets the input of so many steps ago; at least 1. size: of the
    input. Controllers decide before discrete states change at the same instant. So they see one step more than the
    delay of DiscreteTimeDelay.
    """

    def __init__(self, step: float, steps: int, size: int):
        super().__init__(step, steps - 1, size)
        self._places = steps

    def Begin(self, root_context: Context, rng: np.random.Generator | None = None) -> None:
        """Fills the line with the present input. Call it when all other systems have their start state."""
        context = self.GetMyMutableContextFromRoot(root_context)
        context.SetDiscreteState(np.tile(self.get_input_port().Eval(context), self._places))
