"""Values of muscles that a file does not give, or that its program does not have."""

from typing import Any

from drakearm.model import Muscle

_GENERIC = (  # the defaults of drakearm, which says their sources
    "minimum_activation",
    "passive_strain",
    "active_width",
    "force_velocity_shape",
    "eccentric_force",
    "specific_tension",
    "slow_twitch_fraction",
)
# Tendon and passive curve are those of OpenSim's DeGrooteFregly2016Muscle.
ASSUMED: dict[str, Any] = {name: Muscle.__dataclass_fields__[name].default for name in _GENERIC} | {
    "tendon_strain": 0.049,
    "passive_shape": 4.0,
}
