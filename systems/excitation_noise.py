"""ExcitationNoise: factors on excitations that change from control step to control step."""

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drakearm.model.reference import CONTROL_STEP


class ExcitationNoise(LeafSystem):
    """Multiplies each excitation by a factor of the present control step: signal-dependent noise.

    .. pydrake_system::

        name: ExcitationNoise
        input_ports:
        - u
        output_ports:
        - noisy_u

    ======= ==== ==== ==========================================================
    port    size unit meaning
    ======= ==== ==== ==========================================================
    u       n    1    excitations, which are clamped to 0..1 first
    noisy_u n    1    the same with noise; muscles clamp them to 0..1
    ======= ==== ==== ==========================================================

    The factors are 1 until `SetFactors` is called. See `Episode.noise_factors`.
    """

    def __init__(self, n: int):
        super().__init__()
        self._u = self.DeclareVectorInputPort("u", n)
        self._factors = self.DeclareAbstractParameter(AbstractValue.Make(np.ones((1, n))))
        self.DeclareVectorOutputPort("noisy_u", n, self._calc_noisy)

    def SetFactors(self, root_context: Context, factors: np.ndarray) -> None:
        """Sets the factors (steps, n) of all control steps from time 0 on. The last ones hold afterwards."""
        context = self.GetMyMutableContextFromRoot(root_context)
        context.get_mutable_abstract_parameter(self._factors).set_value(factors)

    def _calc_noisy(self, context: Context, output: BasicVector) -> None:
        factors = context.get_abstract_parameter(self._factors).get_value()
        # A step begins at its exact time, so a little more is added than what times are rounded by.
        step = min(int(context.get_time() / CONTROL_STEP + 1e-6), len(factors) - 1)
        output.SetFromVector(np.clip(self._u.Eval(context), 0.0, 1.0) * factors[step])
