"""The table of the muscle models, and one function per curve, which calls that curve of the muscle's own model.

Curves are dimensionless: forces over max_isometric_force, fiber lengths over optimal_fiber_length, velocities over
max_contraction_velocity. `m` is a record of `MUSCLE_DTYPE`. Each curve returns a value and its slope, except
`velocity_of_force`.

A model is a module with these curves and `passive_constants`. To add one, write its module and name it here and in
`drakearm.model.muscle_lanes`. Importing these two modules fails until each of their functions that chooses by model
names all models.
"""

import math
from types import ModuleType
from typing import Any

from drakearm.muscle import degroote2016, thelen2003
from drakearm.muscle.compiled import inlined

MODELS: dict[str, ModuleType] = {"thelen2003": thelen2003, "degroote2016": degroote2016}
THELEN2003, DEGROOTE2016 = range(len(MODELS))
MODEL_CODES = {name: code for code, name in enumerate(MODELS)}  # the field model_code of `MUSCLE_DTYPE`

# Compiled functions cannot look up a module in MODELS, so each model's curves get names here.
_thelen2003_active, _degroote2016_active = (model.active_force_length for model in MODELS.values())
_thelen2003_passive, _degroote2016_passive = (model.passive_force_length for model in MODELS.values())
_thelen2003_tendon, _degroote2016_tendon = (model.tendon_force_strain for model in MODELS.values())
_thelen2003_velocity, _degroote2016_velocity = (model.velocity_of_force for model in MODELS.values())
_thelen2003_force, _degroote2016_force = (model.force_of_velocity for model in MODELS.values())
_thelen2003_scale, _degroote2016_scale = (model.velocity_scale for model in MODELS.values())


def names_every_model(function: Any) -> Any:
    """Checks that a compiled function, which chooses by muscle model, names the codes of all models, and returns it.

    Raises TypeError if it does not name them all.
    """
    missing = {name.upper() for name in MODELS} - set(function.py_func.__code__.co_names)
    if missing:
        raise TypeError(f"{function.py_func.__name__} must choose by muscle model, but lacks {', '.join(missing)}.")
    return function


@names_every_model
@inlined
def active_force_length(length, m):
    """Active isometric force at a fiber length."""
    if m.model_code == THELEN2003:
        return _thelen2003_active(length, m)
    if m.model_code == DEGROOTE2016:
        return _degroote2016_active(length, m)
    return math.nan, math.nan


@names_every_model
@inlined
def passive_force_length(length, m):
    """Passive force at a fiber length."""
    if m.model_code == THELEN2003:
        return _thelen2003_passive(length, m)
    if m.model_code == DEGROOTE2016:
        return _degroote2016_passive(length, m)
    return math.nan, math.nan


@names_every_model
@inlined
def tendon_force_strain(strain, m):
    """Tendon force at a tendon strain."""
    if m.model_code == THELEN2003:
        return _thelen2003_tendon(strain, m)
    if m.model_code == DEGROOTE2016:
        return _degroote2016_tendon(strain, m)
    return math.nan, math.nan


@names_every_model
@inlined
def velocity_of_force(active, isometric, m):
    """Fiber velocity at full activation, as a fraction, at an active force and the isometric force of that length.

    Returns numerator, denominator, and two slopes as numerators over the same denominator: that with respect to
    `active`, and minus that with respect to `isometric`.
    """
    if m.model_code == THELEN2003:
        return _thelen2003_velocity(active, isometric, m)
    if m.model_code == DEGROOTE2016:
        return _degroote2016_velocity(active, isometric, m)
    return math.nan, math.nan, math.nan, math.nan


@names_every_model
@inlined
def force_of_velocity(velocity, m):
    """Active force over isometric force at a fiber velocity, at full activation: the inverse of `velocity_of_force`."""
    if m.model_code == THELEN2003:
        return _thelen2003_force(velocity, m)
    if m.model_code == DEGROOTE2016:
        return _degroote2016_force(velocity, m)
    return math.nan, math.nan


@names_every_model
@inlined
def velocity_scale(activation, m):
    """Factor between the velocity at an activation and the velocity at full activation."""
    if m.model_code == THELEN2003:
        return _thelen2003_scale(activation, m)
    if m.model_code == DEGROOTE2016:
        return _degroote2016_scale(activation, m)
    return math.nan, math.nan
