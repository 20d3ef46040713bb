"""The muscle load: how much of the time the flexors and the extensors of a joint are active above 80 %."""

from dataclasses import dataclass

import numpy as np

from drakearm.model import Arm
from drakearm.model.musculature import muscle_geometry
from drakearm.model.recording import Recording

THRESHOLD = 0.8  # of the maximum activation, which is 1


@dataclass(frozen=True)
class Groups:
    """The places of a joint's flexors and extensors among the muscles of an arm."""

    flexors: np.ndarray
    extensors: np.ndarray


def muscle_groups(arm: Arm, joint: int, q: np.ndarray) -> Groups:
    """Which muscles raise the angle of a joint, and which lower it, at the postures q (N, n_q), rad, of a movement.

    A muscle belongs where its mean moment arm over the postures says. Muscles that do not cross the joint are in
    neither group.
    """
    arms = [muscle_geometry(posture, arm.muscle_table, arm.path_table)[1][:, joint] for posture in q]
    mean = np.mean(arms, axis=0)
    return Groups(np.flatnonzero(mean > 0.0), np.flatnonzero(mean < 0.0))


def muscle_load(recording: Recording, muscles: np.ndarray) -> float:
    """The share of the time that a muscle is active above `THRESHOLD`, mean over some muscles.

    After Denizdurduran et al. (2022).
    """
    return float((recording.activation[:, muscles] > THRESHOLD).mean())
