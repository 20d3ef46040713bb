"""The numbers that describe muscles to the compiled functions: one record per muscle."""

from typing import NamedTuple

import numpy as np

from drakearm.muscle.compiled import inlined


class MuscleParameters(NamedTuple):
    """The numbers of a `drakearm.model.Muscle`: some of its fields and properties. Units: m, N, s, rad, Pa, kg."""

    model_code: int  # see `drakearm.muscle.models`
    rigid_tendon: bool
    max_isometric_force: float
    optimal_fiber_length: float
    tendon_slack_length: float
    max_contraction_velocity: float  # optimal fiber lengths per second
    activation_time: float
    deactivation_time: float
    minimum_activation: float
    tendon_strain: float  # at max_isometric_force
    passive_strain: float  # at max_isometric_force
    passive_shape: float
    active_width: float
    force_velocity_shape: float
    eccentric_force: float  # over isometric force
    slow_twitch_fraction: float
    mass: float
    fiber_width: float  # optimal_fiber_length * sin(pennation_angle), the same at every fiber length
    minimum_fiber_length: float  # > 0; of a pennated fiber, where the pennation angle reaches acos(0.1)
    passive_offset: float  # the passive force is passive_scale * (exp(...) - passive_offset), see `passive_constants`
    passive_scale: float


_NUMPY_TYPES = {int: np.int64, bool: np.bool_, float: np.float64}
MUSCLE_DTYPE = np.dtype([(name, _NUMPY_TYPES[t]) for name, t in MuscleParameters.__annotations__.items()], align=True)


@inlined
def muscle_parameters(record, model_code):
    """The numbers of a record as a named tuple of values: the compiler then knows that loops do not change them.

    model_code: that of the record. If it is given as a constant, the code that uses the result is compiled for this
    model alone.
    """
    return MuscleParameters(
        model_code,
        record.rigid_tendon,
        record.max_isometric_force,
        record.optimal_fiber_length,
        record.tendon_slack_length,
        record.max_contraction_velocity,
        record.activation_time,
        record.deactivation_time,
        record.minimum_activation,
        record.tendon_strain,
        record.passive_strain,
        record.passive_shape,
        record.active_width,
        record.force_velocity_shape,
        record.eccentric_force,
        record.slow_twitch_fraction,
        record.mass,
        record.fiber_width,
        record.minimum_fiber_length,
        record.passive_offset,
        record.passive_scale,
    )
