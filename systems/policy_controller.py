"""PolicyController: lets a policy decide the excitations at every control step."""

from collections.abc import Callable

import numpy as np
from pydrake.systems.framework import Context, LeafSystem, State

Policy = Callable[[np.ndarray], np.ndarray]


class PolicyController(LeafSystem):
    """Evaluates a policy at every control step and holds its excitations until the next one.

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
    excitation  n                0..1 held for one control step; 0 before the first
    =========== ================ ==== ===========================================

    policy: any function from an observation to excitations, such as `drakearm.learning.Policy.act`. n_observation,
    n_excitation: their sizes. control_step: s. The decision is an unrestricted update. Drake makes such updates before
    the discrete updates of the same instant, so discrete muscles use a new excitation already in the step that begins
    when it is decided.
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
