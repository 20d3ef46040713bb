"""The time step of the muscles of many arms, simulated side by side, one arm per lane.

The equations and tables are those of `musculature.muscle_step`, which steps the muscles of one arm and documents the
method. tests/model/test_muscle_lanes.py compares the two. All arms have the same muscles. The outer loops go over the
muscles, the inner ones over the lanes, which the compiler turns into vector instructions: `drakearm.muscle.compiled`
explains lanes and the rules for such code. The code is compiled separately for each kind of muscle, because a choice
inside a loop over lanes would prevent vector instructions.
"""

from typing import NamedTuple

import numpy as np

from drakearm.model.paths import PathPieces, count_slopes, evaluate_path_lanes, make_path_pieces
from drakearm.muscle.activation import activation_step
from drakearm.muscle.compiled import fma, inlined, inner
from drakearm.muscle.contraction import (
    bdf2_base,
    fiber_steps,
    rigid_fiber,
    rigid_tendon_force,
    shortest_fiber,
    tendon_force,
)
from drakearm.muscle.models import DEGROOTE2016, MODEL_CODES, MODELS, THELEN2003, names_every_model
from drakearm.muscle.parameters import muscle_parameters


class MuscleKinds(NamedTuple):
    """The indices of the muscles of each kind. A kind without muscles is None: no code is compiled for it."""

    thelen2003: np.ndarray | None  # this model, compliant tendon
    degroote2016: np.ndarray | None  # this model, compliant tendon
    rigid: np.ndarray | None  # any model, rigid tendon


def muscle_kinds(muscles: np.ndarray) -> MuscleKinds:
    """The kinds of the muscles of a `muscle_table`."""
    rigid, code = muscles["rigid_tendon"], muscles["model_code"]
    masks = {"rigid": rigid} | {name: ~rigid & (code == MODEL_CODES[name]) for name in MODELS}
    return MuscleKinds(**{kind: np.flatnonzero(mask) if mask.any() else None for kind, mask in masks.items()})


class MuscleLanes(NamedTuple):
    """Working memory of `step_muscle_lanes`. "later" means: at the end of the time step."""

    pieces: PathPieces
    length: np.ndarray  # (n, lanes) m, of the musculotendon paths
    slope: np.ndarray  # (terms, lanes) m/rad, of the path functions
    speed: np.ndarray  # (n, lanes) m/s, of the musculotendon paths; computed only if a muscle has a rigid tendon
    force: np.ndarray  # (n, lanes) N, of the tendons
    later_pieces: PathPieces
    later_length: np.ndarray
    later_slope: np.ndarray
    later_speed: np.ndarray
    later_force: np.ndarray
    later_q: np.ndarray  # (n_q, lanes) rad
    fiber: np.ndarray  # (lanes,) m, later fiber length of one muscle


def make_muscle_lanes(n: int, paths: np.ndarray, n_q: int, lanes: int) -> MuscleLanes:
    """Working memory for `lanes` arms with n muscles and n_q coordinates each. paths: `Arm.path_table`."""
    terms = count_slopes(paths)
    return MuscleLanes(
        make_path_pieces(paths, lanes),
        np.empty((n, lanes)),
        np.empty((terms, lanes)),
        np.empty((n, lanes)),
        np.empty((n, lanes)),
        make_path_pieces(paths, lanes),
        np.empty((n, lanes)),
        np.empty((terms, lanes)),
        np.empty((n, lanes)),
        np.empty((n, lanes)),
        np.empty((n_q, lanes)),
        np.empty(lanes),
    )


@inlined
def _step_compliant(state, excitation, i, n, time_step, work, m):
    """Advances muscle i, which has a compliant tendon, in every lane, and writes its tendon forces into `work`."""
    length, force, later_length, later_force = work.length, work.force, work.later_length, work.later_force
    fiber = work.fiber
    for k in range(len(fiber)):
        force[i, k] = tendon_force(state[n + i, k], length[i, k], m)[0]
        state[i, k] = activation_step(state[i, k], excitation[i, k], time_step, m)
        fiber[k] = max(fma(2.0 * time_step, state[3 * n + i, k], state[2 * n + i, k]), shortest_fiber(m))
    fiber_steps(fiber, state, i, n, later_length, time_step, m)
    for k in range(len(fiber)):
        later_force[i, k] = tendon_force(fiber[k], later_length[i, k], m)[0]
        base = bdf2_base(state[n + i, k], state[2 * n + i, k])
        state[3 * n + i, k] = 1.5 / time_step * (fiber[k] - base)
        state[2 * n + i, k] = state[n + i, k]
        state[n + i, k] = fiber[k]


@inlined
def _step_rigid(state, excitation, i, n, time_step, work, m):
    """Advances muscle i, which has a rigid tendon, in every lane, and writes its tendon forces into `work`."""
    length, speed, force = work.length, work.speed, work.force
    later_length, later_speed, later_force = work.later_length, work.later_speed, work.later_force
    for k in range(len(work.fiber)):
        force[i, k] = rigid_tendon_force(state[i, k], length[i, k], speed[i, k], m)[0]
        state[i, k] = activation_step(state[i, k], excitation[i, k], time_step, m)
        later_force[i, k] = rigid_tendon_force(state[i, k], later_length[i, k], later_speed[i, k], m)[0]
        state[2 * n + i, k] = state[n + i, k]
        state[n + i, k], state[3 * n + i, k], _ = rigid_fiber(later_length[i, k], later_speed[i, k], m)


@names_every_model
@inner
def step_muscle_lanes(
    state, tau, excitation, arm_state, time_step, muscles, strength, paths, work, thelen2003, degroote2016, rigid
):
    """`musculature.muscle_step` for several arms: every array has the lane as a second index.

    state: (4 n, lanes). tau: (n_q, lanes). excitation: (n, lanes). arm_state: (2 n_q, lanes). strength: (n, lanes),
    factors of the maximum isometric forces in `muscles`. Tendons are as much stiffer, so the fibers move as without the
    factors, and only the torques grow. work: see `make_muscle_lanes`. thelen2003, degroote2016, rigid: the fields of
    `MuscleKinds`. They are separate arguments because Numba leaves out the code for an argument that is None, but not
    the code for a field that is None.
    """
    n, (n_q, lanes) = len(muscles), tau.shape
    for j in range(n_q):
        for k in range(lanes):
            work.later_q[j, k] = fma(time_step, arm_state[n_q + j, k], arm_state[j, k])
    evaluate_path_lanes(arm_state, paths, work.pieces, work.length, work.slope)
    evaluate_path_lanes(work.later_q, paths, work.later_pieces, work.later_length, work.later_slope)
    if thelen2003 is not None:
        for i in thelen2003:
            m = muscle_parameters(muscles[i], THELEN2003)
            _step_compliant(state, excitation, i, n, time_step, work, m)
    if degroote2016 is not None:
        for i in degroote2016:
            m = muscle_parameters(muscles[i], DEGROOTE2016)
            _step_compliant(state, excitation, i, n, time_step, work, m)
    if rigid is not None:
        _path_speeds(arm_state, paths, work.slope, work.speed)
        _path_speeds(arm_state, paths, work.later_slope, work.later_speed)
        for i in rigid:
            m = muscle_parameters(muscles[i], muscles[i].model_code)
            _step_rigid(state, excitation, i, n, time_step, work, m)
    slope, force, later_slope, later_force = work.slope, work.force, work.later_slope, work.later_force
    tau[:] = 0.0
    header = term = 0
    while header < len(paths):
        i, j = int(paths[header, 0]), int(paths[header, 1])
        for k in range(lanes):
            twice = fma(slope[term, k], force[i, k], later_slope[term, k] * later_force[i, k])
            tau[j, k] = fma(-0.5 * strength[i, k], twice, tau[j, k])
        header += 1 + int(paths[header, 2])
        term += 1


@inner
def _path_speeds(arm_state, paths, slope, speed):
    """Writes the rates of change (n, lanes), m/s, of the musculotendon lengths into `speed`."""
    speed[:] = 0.0
    n_q, lanes = arm_state.shape[0] // 2, arm_state.shape[1]
    header = term = 0
    while header < len(paths):
        i, j = int(paths[header, 0]), int(paths[header, 1])
        for k in range(lanes):
            speed[i, k] += slope[term, k] * arm_state[n_q + j, k]
        header += 1 + int(paths[header, 2])
        term += 1
