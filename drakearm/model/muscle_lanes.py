"""The muscles of many arms, stepped side by side: loops over the lanes that the compiler can vectorize.

Same muscles, same equations and same tables as `musculature.muscle_step`, which steps those of one arm; see there.
"""

from typing import NamedTuple

import numpy as np

from drakearm.model.paths import PathPieces, count_terms, evaluate_path_lanes, make_path_pieces
from drakearm.muscle.activation import activation_step
from drakearm.muscle.compiled import inlined, inner
from drakearm.muscle.contraction import (
    bdf2_base,
    fiber_steps,
    rigid_fiber,
    rigid_tendon_force,
    shortest_fiber,
    tendon_force,
)
from drakearm.muscle.parameters import DEGROOTE2016, THELEN2003, muscle_parameters


class MuscleLanes(NamedTuple):
    """Working memory of `step_muscle_lanes`. Rows of now, then of the end of the step, stand beside each other."""

    pieces: PathPieces
    q: np.ndarray  # (n_q, 2 lanes)
    length: np.ndarray  # (n, 2 lanes), of the musculotendon paths
    slope: np.ndarray  # (terms, 2 lanes), of the path functions
    speed: np.ndarray  # (n, 2 lanes), of the musculotendon paths, where tendons are rigid
    force: np.ndarray  # (n, 2 lanes), of the tendons
    later: np.ndarray  # (lanes,), fiber lengths


@inner
def make_muscle_lanes(muscles, paths, n_q, lanes):
    """Working memory for `lanes` arms with the same muscles."""
    n, terms = len(muscles), count_terms(paths)
    return MuscleLanes(
        make_path_pieces(paths, 2 * lanes),
        np.empty((n_q, 2 * lanes)),
        np.empty((n, 2 * lanes)),
        np.empty((terms, 2 * lanes)),
        np.zeros((n, 2 * lanes)),
        np.empty((n, 2 * lanes)),
        np.empty(lanes),
    )


@inlined
def _step_compliant(state, excitation, i, n, time_step, length, force, later, m):
    """Advances muscle i, on a compliant tendon, in every lane."""
    lanes = len(later)
    for k in range(lanes):
        force[i, k] = tendon_force(state[n + i, k], length[i, k], m)[0]
    for k in range(lanes):
        state[i, k] = activation_step(state[i, k], excitation[i, k], time_step, m)
    for k in range(lanes):
        later[k] = max(state[2 * n + i, k] + 2.0 * time_step * state[3 * n + i, k], shortest_fiber(m))
    fiber_steps(later, state, i, n, length, lanes, time_step, m)
    for k in range(lanes):
        force[i, lanes + k] = tendon_force(later[k], length[i, lanes + k], m)[0]
    for k in range(lanes):
        base = bdf2_base(state[n + i, k], state[2 * n + i, k])
        state[3 * n + i, k] = 1.5 / time_step * (later[k] - base)
        state[2 * n + i, k] = state[n + i, k]
        state[n + i, k] = later[k]


@inlined
def _step_rigid(state, excitation, i, n, time_step, length, speed, force, m):
    """Advances muscle i, on a rigid tendon, in every lane."""
    lanes = state.shape[1]
    for k in range(lanes):
        force[i, k] = rigid_tendon_force(state[i, k], length[i, k], speed[i, k], m)[0]
        state[i, k] = activation_step(state[i, k], excitation[i, k], time_step, m)
        next_length, next_speed = length[i, lanes + k], speed[i, lanes + k]
        force[i, lanes + k] = rigid_tendon_force(state[i, k], next_length, next_speed, m)[0]
        state[2 * n + i, k] = state[n + i, k]
        state[n + i, k], state[3 * n + i, k], _ = rigid_fiber(next_length, next_speed, m)


@inner
def step_muscle_lanes(state, tau, excitation, arm_state, time_step, muscles, paths, work):
    """`muscle_step` for arms side by side: every array has a second index, the lane, and `work` is for so many."""
    pieces, q, length, slope, speed, force, later = work
    n, (n_q, lanes) = len(muscles), tau.shape
    for j in range(n_q):
        for k in range(lanes):
            q[j, k] = arm_state[j, k]
            q[j, lanes + k] = arm_state[j, k] + time_step * arm_state[n_q + j, k]
    evaluate_path_lanes(q, paths, pieces, length, slope)
    _path_speeds(arm_state, paths, slope, speed)
    for i in range(n):
        # A branch for each model, so that each is compiled without the curves of the other.
        if muscles[i].rigid_tendon:
            m = muscle_parameters(muscles[i], muscles[i].model_code)
            _step_rigid(state, excitation, i, n, time_step, length, speed, force, m)
        elif muscles[i].model_code == THELEN2003:
            m = muscle_parameters(muscles[i], THELEN2003)
            _step_compliant(state, excitation, i, n, time_step, length, force, later, m)
        else:
            m = muscle_parameters(muscles[i], DEGROOTE2016)
            _step_compliant(state, excitation, i, n, time_step, length, force, later, m)
    tau[:] = 0.0
    header = term = 0
    while header < len(paths):
        i, j = int(paths[header, 0]), int(paths[header, 1])
        for k in range(lanes):
            tau[j, k] -= 0.5 * (slope[term, k] * force[i, k] + slope[term, lanes + k] * force[i, lanes + k])
        header += 1 + int(paths[header, 2])
        term += 1


@inner
def _path_speeds(arm_state, paths, slope, speed):
    """Writes the rates of change (n, 2 lanes) of the musculotendon lengths."""
    speed[:] = 0.0
    n_q, lanes = arm_state.shape[0] // 2, arm_state.shape[1]
    header = term = 0
    while header < len(paths):
        i, j = int(paths[header, 0]), int(paths[header, 1])
        for k in range(lanes):
            speed[i, k] += slope[term, k] * arm_state[n_q + j, k]
            speed[i, lanes + k] += slope[term, lanes + k] * arm_state[n_q + j, k]
        header += 1 + int(paths[header, 2])
        term += 1
