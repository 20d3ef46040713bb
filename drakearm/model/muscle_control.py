"""Computed muscle control (Thelen, Anderson and Delp 2003) for many arms in one compiled call."""

import numpy as np

from drakearm.model.dynamics import equations_of_motion
from drakearm.model.static_optimization import acceleration_weighting, excitations_to_reach, static_activations
from drakearm.muscle.compiled import compiled


@compiled
def excitations_for(q, v, a, activation, guess, priority, time_step, muscles, paths, dynamics):
    """The excitations (N, n) by which the muscles of N arms give them the accelerations a (N, n_q), rad/s^2, best.

    q, v: joint angles and speeds (N, n_q) at which the muscles shall exert the torques. activation: (N, n), present
    ones, which the excitations bring to those of static optimization within time_step (s). guess: (N, n), activations
    from which static optimization starts; they are replaced by its solution. priority: (N, n_q), see
    `acceleration_weighting`. dynamics: the stacked `DynamicsTable` of the arms' skeletons.
    """
    count, n_q = q.shape
    mass_coefficient = dynamics.mass_coefficient.reshape(count, -1)
    gravity_coefficient = dynamics.gravity_coefficient.reshape(count, -1)
    excitation, tau = np.empty_like(activation), np.empty(n_q)
    for k in range(count):
        mass, h = equations_of_motion(q[k], v[k], dynamics, mass_coefficient[k], gravity_coefficient[k])
        for i in range(n_q):
            tau[i] = -h[i]
            for j in range(n_q):
                tau[i] += mass[i, j] * a[k, j]
        weighting = acceleration_weighting(mass, priority[k])
        desired, _ = static_activations(q[k], v[k], tau, guess[k], weighting, muscles, paths)
        guess[k] = desired
        excitation[k] = excitations_to_reach(desired, activation[k], time_step, muscles)
    return excitation
