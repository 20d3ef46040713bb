"""Values of muscles that a file does not give, or that its program does not have."""

from typing import Any

ASSUMED: dict[str, Any] = {
    "minimum_activation": 0.01,
    "tendon_strain": 0.049,
    "passive_strain": 0.6,
    "passive_shape": 4.0,
    "active_width": 0.45,
    "force_velocity_shape": 0.25,
    "eccentric_force": 1.4,
    "specific_tension": 0.25e6,  # as OpenSim's metabolics probe assumes, and the next
    "slow_twitch_fraction": 0.5,
}
