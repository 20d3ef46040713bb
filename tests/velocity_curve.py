"""The force-velocity curve as a function of one number, as tests want it."""

from drakearm.muscle import models

ISOMETRIC = 0.7  # any force: the velocity depends on the ratio to it alone


def velocity_of_ratio(ratio, m):
    """Velocity and its slope at a ratio of active to isometric force."""
    numerator, denominator, by_active, _ = models.velocity_of_force(ratio * ISOMETRIC, ISOMETRIC, m)
    return numerator / denominator, by_active * ISOMETRIC / denominator
