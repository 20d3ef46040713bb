"""First derivatives of the muscles' equations, for automatic differentiation of `HillMuscles`."""

import numpy as np

from drakearm.model.musculature import mtu_velocity
from drakearm.model.paths import evaluate_path_curvatures, evaluate_paths
from drakearm.muscle.activation import activation_rate
from drakearm.muscle.compiled import compiled
from drakearm.muscle.contraction import (
    fiber_velocity,
    rigid_fiber,
    rigid_tendon_force,
    shortest_fiber,
    tendon_force,
)


@compiled
def linearize_muscles(fibers, excitation, arm_state, muscles, paths):
    """Values (4 n + n_q,) and Jacobian (4 n + n_q, 3 n + 2 n_q) of the equations of n muscles, in SI.

    The values are the activation rates, fiber velocities, tendon forces and musculotendon lengths, (n,) each, and the
    generalized force (n_q,). The columns of the Jacobian are the derivatives by activations, fiber lengths,
    excitations, q and v. fibers: activations and fiber lengths (2 n,). muscles, paths: the tables of an `Arm`.
    """
    n, n_q = len(muscles), len(arm_state) // 2
    q, v = arm_state[:n_q], arm_state[n_q:]
    length, moment_arm, curvature = np.empty(n), np.empty((n, n_q)), np.empty((n, n_q, n_q))
    evaluate_paths(q, paths, length, moment_arm)
    evaluate_path_curvatures(q, paths, curvature)
    value = np.zeros(4 * n + n_q)
    jacobian = np.zeros((4 * n + n_q, 3 * n + 2 * n_q))
    for i in range(n):
        m = muscles[i]
        speed = mtu_velocity(i, moment_arm, v)
        rate, rate_by_a, rate_by_u = activation_rate(fibers[i], excitation[i], m)
        velocity_by_speed = force_by_speed = force_by_a = force_by_fiber = 0.0
        if m.rigid_tendon:
            fiber, velocity, cosine = rigid_fiber(length[i], speed, m)
            moving = 1.0 if fiber > shortest_fiber(m) else 0.0
            velocity_by_a = velocity_by_fiber = 0.0
            velocity_by_length = moving * speed * m.fiber_width**2 / fiber**3
            velocity_by_speed = moving * cosine
            force, force_by_a, force_by_length, force_by_speed = rigid_tendon_force(fibers[i], length[i], speed, m)
        else:
            velocity, velocity_by_a, velocity_by_fiber, velocity_by_length = fiber_velocity(
                fibers[i], fibers[n + i], length[i], m
            )
            force, force_by_fiber, force_by_length = tendon_force(fibers[n + i], length[i], m)

        value[i], value[n + i], value[2 * n + i], value[3 * n + i] = rate, velocity, force, length[i]
        jacobian[i, i], jacobian[i, 2 * n + i] = rate_by_a, rate_by_u
        jacobian[n + i, i], jacobian[n + i, n + i] = velocity_by_a, velocity_by_fiber
        jacobian[2 * n + i, i], jacobian[2 * n + i, n + i] = force_by_a, force_by_fiber
        for j in range(n_q):
            arm, at_q, at_v = moment_arm[i, j], 3 * n + j, 3 * n + n_q + j
            speed_by_q = 0.0
            for k in range(n_q):
                speed_by_q += curvature[i, j, k] * v[k]
            jacobian[n + i, at_q] = -velocity_by_length * arm + velocity_by_speed * speed_by_q
            jacobian[n + i, at_v] = -velocity_by_speed * arm
            jacobian[2 * n + i, at_q] = -force_by_length * arm + force_by_speed * speed_by_q
            jacobian[2 * n + i, at_v] = -force_by_speed * arm
            jacobian[3 * n + i, at_q] = -arm
        for j in range(n_q):
            value[4 * n + j] += moment_arm[i, j] * force
            for k in range(3 * n + 2 * n_q):
                jacobian[4 * n + j, k] += moment_arm[i, j] * jacobian[2 * n + i, k]
            for k in range(n_q):
                jacobian[4 * n + j, 3 * n + k] -= curvature[i, j, k] * force
    return value, jacobian
