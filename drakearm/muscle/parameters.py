"""The numbers that describe muscles to the compiled functions: one record a muscle."""

import numpy as np

THELEN2003, DEGROOTE2016 = 0, 1
MODEL_CODES = {"thelen2003": THELEN2003, "degroote2016": DEGROOTE2016}

# Field by field what `drakearm.model.Muscle` holds, plus what follows from it. Units: m, N, s, rad, Pa, kg.
MUSCLE_DTYPE = np.dtype(
    [
        ("model_code", np.int64),
        ("rigid_tendon", np.bool_),
        ("max_isometric_force", np.float64),
        ("optimal_fiber_length", np.float64),
        ("tendon_slack_length", np.float64),
        ("max_contraction_velocity", np.float64),  # optimal fiber lengths per second
        ("activation_time", np.float64),
        ("deactivation_time", np.float64),
        ("minimum_activation", np.float64),
        ("tendon_strain", np.float64),  # at max_isometric_force
        ("passive_strain", np.float64),  # at max_isometric_force
        ("passive_shape", np.float64),
        ("active_width", np.float64),
        ("force_velocity_shape", np.float64),
        ("eccentric_force", np.float64),  # over isometric force
        ("slow_twitch_fraction", np.float64),
        ("mass", np.float64),
        ("fiber_width", np.float64),  # optimal_fiber_length * sin(pennation_angle): constant
        ("minimum_fiber_length", np.float64),  # where pennation reaches acos(0.1)
        ("toe_strain", np.float64),  # tendon strain where the exponential toe region ends
        ("tendon_stiffness", np.float64),  # beyond the toe region, over max_isometric_force, per strain
    ],
    align=True,
)
