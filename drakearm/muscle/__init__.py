"""The equations of one muscle: curves, activation, contraction and power, as pure functions compiled with Numba.

`drakearm.model.musculature` applies them to all muscles of one arm, and `drakearm.model.muscle_lanes` to the muscles of
many arms at once. `drakearm.muscle.compiled` explains how such functions are written.
"""
