"""PolicyController: lets a policy decide the excitations at every control step."""

from collections.abc import Callable

import numpy as np
from pydrake.systems.framework import Context, LeafSystem, State

Policy = Callable[[np.ndarray], np.ndarray]


class PolicyController(LeafSystem):
    """Asks a policy for excitations at every control step and holds them in between.

    .. pydrake_system::

        name: PolicyController
        input_ports:
        - observation
        output_ports:
        - excitation

    =========== ================ ==== ===========================================
    port        size             unit meaning
    =========== ================ ==== ===========================================
    observation the policy's     1    see Proprioception
    excitation  one a muscle     0..1 held for one control step; 0 before the first
    =========== ================ ==== ===========================================

    policy: any function from an observation to excitations, `drakearm.learning.Policy.act` for one.
    The decision is an unrestricted update, which Drake handles before discrete updates of the same instant: discrete
    muscles feel a new excitation in the very step in which it was decided.
    """

    def __init__(self, policy: Policy, n_observation: int, n_excitation: int, control_step: float):
        super().__init__()
        self._policy = policy
        self._observation = self.DeclareVectorInputPort("observation", n_observation)
        held = self.DeclareDiscreteState(n_excitation)
        self.DeclareStateOutputPort("excitation", held)
        self.DeclarePeriodicUnrestrictedUpdateEvent(control_step, 0.0, self._decide)

    def _decide(self, context: Context, state: State) -> None:
        excitation = self._policy(self._observation.Eval(context))
        state.get_mutable_discrete_state().set_value(np.asarray(excitation, dtype=float))
