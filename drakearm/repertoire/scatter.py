"""Scatter of the hand under motor noise, and what it means for targets of several sizes: Fitts' law.

People's reaches end at other places each time, because the noise of their muscles grows with excitation (Harris and
Wolpert 1998). So a fast reach misses a small target. The shortest time T to a target of width W at a distance A is
about a + b log2(2 A / W) (Fitts 1954). Here noise of the same kind is added to a policy's excitations.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.stats import linregress

from drakearm.errors import PlanningError
from drakearm.model import MakeTorqueArm
from drakearm.model.reference import CONTROL_STEP
from drakearm.model.skeleton import hand_motion
from drakearm.planning import ReachPlanner, muscle_feasibility, posture_at
from drakearm.repertoire.errors_table import Act, carry_out
from drakearm.task import RandomMotorNoise, TrackingTask
from drakearm.task.starts import ReferenceStart

NOISE = 0.2  # standard deviation of an excitation's noise over the excitation
REPEATS = 16
DISTANCES = (0.1, 0.2, 0.3)  # m
DURATIONS = (0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.8, 1.0)  # s
WIDTHS = (0.002, 0.003, 0.004, 0.006, 0.008, 0.012, 0.02)  # m, of targets
HITS = 0.96  # share of the hands that hit a target, as in experiments with people (Welford 1968)
_DIRECTIONS = 8


class Fitts(NamedTuple):
    """The shortest times to targets, and the line through them."""

    difficulty: np.ndarray  # (K,) bits, log2(2 A / W)
    duration: np.ndarray  # (K,) s
    slope: float  # s/bit
    intercept: float  # s
    correlation: float


def scatter(tasks: Sequence[TrackingTask], act: Act, share: float = NOISE, seed: int = 0) -> np.ndarray:
    """How far (cm) the hand scatters at the end of each task, (K,): the root of the sum of its variances along x, y, z.

    Each task is repeated REPEATS times, with motor noise of this share of the excitation.
    """
    return 100.0 * np.sqrt(_ends(tasks, act, share, seed).var(axis=1, ddof=1).sum(axis=-1))


def _ends(tasks: Sequence[TrackingTask], act: Act, share: float, seed: int) -> np.ndarray:
    """Where the hand is at the end of each repetition of each task, (K, REPEATS, 3), m."""
    noise = (RandomMotorNoise(share),)
    noisy = [replace(task, start=ReferenceStart(), randomization=noise) for task in tasks for _ in range(REPEATS)]
    _, q = carry_out(noisy, act, seed)
    arm = tasks[0].arm
    return hand_motion(MakeTorqueArm(arm), arm, q, np.zeros_like(q))[0].reshape(len(tasks), REPEATS, 3)


def fitts(task: TrackingTask, home: np.ndarray, act: Act, seed: int = 0) -> Fitts | None:
    """The shortest times of reaches from rest at home (n_q,), rad, to targets of the WIDTHS at the DISTANCES.

    task: has the arm and the senses; each reach has a reference of its own. A time is long enough for a target if HITS
    of the hands, over all directions, end within half its width from its middle. Returns None if fewer than three
    targets can be hit.
    """
    planner, reaches = ReachPlanner(task.arm, hold=CONTROL_STEP), []
    for distance in DISTANCES:
        for target in _targets(planner, home, distance):
            for duration in DURATIONS:
                try:
                    reference = planner(home, np.zeros_like(home), target, duration)
                except PlanningError:
                    continue
                if muscle_feasibility(task.arm, reference).feasible:
                    reaches.append((distance, duration, replace(task, reference=reference, load_mass=0.0)))
    if not reaches:
        return None
    tasks = [reach for _, _, reach in reaches]
    q = np.array([reach.reference.q[-1] for reach in tasks])
    goals = hand_motion(MakeTorqueArm(task.arm), task.arm, q, np.zeros_like(q))[0]
    missed = np.linalg.norm(_ends(tasks, act, NOISE, seed) - goals[:, None], axis=-1)
    kind = np.array([(distance, duration) for distance, duration, _ in reaches])
    found = []
    for distance in DISTANCES:
        for width in WIDTHS:
            for duration in DURATIONS:
                alike = missed[(kind == (distance, duration)).all(axis=1)]
                if alike.size and np.mean(alike <= 0.5 * width) >= HITS:
                    found.append((math.log2(2.0 * distance / width), duration))
                    break
    if len(found) < 3:
        return None
    difficulty, duration = np.array(found).T
    line = linregress(difficulty, duration)
    return Fitts(difficulty, duration, float(line.slope), float(line.intercept), float(line.rvalue))


def _targets(planner: ReachPlanner, home: np.ndarray, distance: float) -> list[np.ndarray]:
    """Postures (n_q,), rad, that bring the hand to places around home, as far as it can reach them."""
    arm, plant = planner.model.arm, planner.model.plant
    x, y, _ = hand_motion(plant, arm, home[None], np.zeros_like(home)[None])[0][0]
    postures = []
    for angle in 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS:
        with suppress(PlanningError):
            place = x + distance * np.cos(angle), y + distance * np.sin(angle)
            postures.append(posture_at(planner.model, *place, near=home))
    return postures
