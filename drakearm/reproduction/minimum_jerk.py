"""The speed of a minimum-jerk movement (Flash and Hogan 1985), to which the speed of a hand is compared."""

import numpy as np

from drakearm.reproduction.speed_profile import SpeedProfile, speed_profile

_FINE = 10_001  # samples, so that the cut is exact to four digits


def minimum_jerk_speed(phase: np.ndarray) -> np.ndarray:
    """Speed over mean speed at phases from 0 to 1: the straight movement from rest to rest with the least jerk.

    Flash and Hogan, "The coordination of arm movements", Journal of Neuroscience 5:1688-1703, 1985.
    """
    return 30.0 * phase**2 * (1.0 - phase) ** 2


def minimum_jerk_profile() -> SpeedProfile:
    """The profile of a minimum-jerk movement, cut like those of hands. Its times are shares of the duration."""
    phase = np.linspace(0.0, 1.0, _FINE)
    return speed_profile(phase, minimum_jerk_speed(phase))
