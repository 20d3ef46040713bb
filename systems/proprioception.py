"""Proprioception: what a controller of the arm senses."""

import numpy as np
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drakearm.model import Arm

LOOKAHEAD = (0, 3, 8)  # control steps ahead at which the full observation shows the reference
SPEED_SCALE = 0.1  # s/rad: joint speeds of a movement become numbers near 1

_SENSES = {
    "paper": ("fiber_length", "fiber_velocity"),
    "full": ("fiber_length", "fiber_velocity", "activation", "arm_state", "reference"),
}
OBSERVATIONS = tuple(_SENSES)


def observation_scales(arm: Arm, observation: str) -> dict[str, np.ndarray]:
    """Factors that make each sense of an observation dimensionless, in the order of the observation."""
    muscles, n_q = arm.muscle_table, len(arm.coordinates)
    optimal = muscles["optimal_fiber_length"]
    half = n_q * len(LOOKAHEAD)
    scales = {
        "fiber_length": 1.0 / optimal,
        "fiber_velocity": 1.0 / (optimal * muscles["max_contraction_velocity"]),
        "activation": np.ones(len(muscles)),
        "arm_state": np.repeat([1.0, SPEED_SCALE], n_q),
        "reference": np.repeat([1.0, SPEED_SCALE], half),
    }
    return {sense: scales[sense] for sense in _SENSES[observation]}


class Proprioception(LeafSystem):
    """Concatenates and scales what the arm senses into one observation.

    .. pydrake_system::

        name: Proprioception
        input_ports:
        - fiber_length
        - fiber_velocity
        - activation (full)
        - arm_state (full)
        - reference (full)
        output_ports:
        - observation

    ============== ============ =========== ==========================================================================
    port           size         unit        meaning
    ============== ============ =========== ==========================================================================
    fiber_length   n            m           in the observation: over the optimal fiber length
    fiber_velocity n            m/s         in the observation: over the largest contraction velocity
    activation     n            0..1        as it is
    arm_state      2 n_q        rad, rad/s  q as it is, v times SPEED_SCALE
    reference      2 n_q len(L) rad, rad/s  wanted q at every time of LOOKAHEAD, then wanted v; scaled likewise
    observation    sum of these 1           in the order of the ports
    ============== ============ =========== ==========================================================================

    observation: "paper" for the 28 numbers of Denizdurduran et al. (2022), fiber lengths and velocities; "full" for
    all.
    """

    def __init__(self, arm: Arm, observation: str = "full"):
        super().__init__()
        self.observation = observation
        scales = observation_scales(arm, observation)
        self._scale = np.concatenate(list(scales.values()))
        self._senses = [self.DeclareVectorInputPort(s, len(scale)) for s, scale in scales.items()]
        self.DeclareVectorOutputPort(
            "observation",
            len(self._scale),
            self._calc_observation,
            {port.ticket() for port in self._senses},
        )

    def _calc_observation(self, context: Context, output: BasicVector) -> None:
        sensed = np.concatenate([port.Eval(context) for port in self._senses])
        output.SetFromVector(sensed * self._scale)
