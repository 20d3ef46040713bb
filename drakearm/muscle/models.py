"""The curves of a muscle, by its model: each function passes on to `thelen2003` or `degroote2016`.

Dimensionless: forces over max_isometric_force, fiber lengths over optimal_fiber_length, velocities over
max_contraction_velocity. `m` is a record of `MUSCLE_DTYPE`. Each returns a value and its slope, but for
`velocity_of_force`.
"""

from drakearm.muscle import degroote2016, thelen2003
from drakearm.muscle.compiled import inlined
from drakearm.muscle.parameters import THELEN2003

_thelen_active, _degroote_active = thelen2003.active_force_length, degroote2016.active_force_length
_thelen_passive, _degroote_passive = thelen2003.passive_force_length, degroote2016.passive_force_length
_thelen_tendon, _degroote_tendon = thelen2003.tendon_force_strain, degroote2016.tendon_force_strain
_thelen_velocity, _degroote_velocity = thelen2003.velocity_of_force, degroote2016.velocity_of_force
_thelen_force, _degroote_force = thelen2003.force_of_velocity, degroote2016.force_of_velocity
_thelen_scale = thelen2003.velocity_scale


@inlined
def active_force_length(length, m):
    """Active isometric force at a fiber length."""
    if m.model_code == THELEN2003:
        return _thelen_active(length, m)
    return _degroote_active(length, m)


@inlined
def passive_force_length(length, m):
    """Passive force at a fiber length."""
    if m.model_code == THELEN2003:
        return _thelen_passive(length, m)
    return _degroote_passive(length, m)


@inlined
def tendon_force_strain(strain, m):
    """Tendon force at a tendon strain."""
    if m.model_code == THELEN2003:
        return _thelen_tendon(strain, m)
    return _degroote_tendon(strain, m)


@inlined
def velocity_of_force(active, isometric, m):
    """Fiber velocity at full activation where `active` force meets `isometric` force, as a fraction.

    Numerator, denominator, and over the same denominator the slope by `active` and minus that by `isometric`.
    """
    if m.model_code == THELEN2003:
        return _thelen_velocity(active, isometric, m)
    return _degroote_velocity(active, isometric, m)


@inlined
def force_of_velocity(velocity, m):
    """Active force over isometric force at a fiber velocity, at full activation: the inverse of `velocity_of_force`."""
    if m.model_code == THELEN2003:
        return _thelen_force(velocity, m)
    return _degroote_force(velocity, m)


@inlined
def velocity_scale(activation, m):
    """Factor by which an activation changes the velocity of full activation."""
    if m.model_code == THELEN2003:
        return _thelen_scale(activation)
    return 1.0, 0.0
