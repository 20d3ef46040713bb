"""A recording: the motion of an arm and its muscles in one closed-loop run, sampled at the control steps.

One file holds one recording, or the recordings of several runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np

from drakearm.errors import RunFolderError, shown
from drakearm.files.arrays import Layout, array_problem, load_arrays, load_stack, save_arrays, save_stack
from drakearm.model.arm import Arm
from drakearm.model.reference import CONTROL_STEP, time_problem

_LARGEST_ANGLE, _LARGEST_SPEED = 1e3, 1e6  # rad, rad/s: an arm that is out of control may turn fast
_Angles = Annotated[np.ndarray, Layout(("N", "n_q"), -_LARGEST_ANGLE, _LARGEST_ANGLE)]
_Speeds = Annotated[np.ndarray, Layout(("N", "n_q"), -_LARGEST_SPEED, _LARGEST_SPEED)]
_PerMuscle = Annotated[np.ndarray, Layout(("N", "n"))]
_InWorld = Annotated[np.ndarray, Layout(("N", 3))]


@dataclass(frozen=True)
class Recording:
    """Samples at times t (N,), in SI units and radians, of n_q joints and n muscles.

    q, v, reference_q, reference_v: (N, n_q). p_WH, v_WH: (N, 3). joint_moment: (N, n, n_q). reward: (N,). All others:
    (N, n), as `HillMuscles` describes them. The excitation of a sample was held during the control step that ends at
    the time of the sample. It is what the controller commanded, before motor noise and other perturbations of it.
    """

    t: Annotated[np.ndarray, Layout(("N",))]
    q: _Angles
    v: _Speeds
    reference_q: _Angles
    reference_v: _Speeds
    excitation: _PerMuscle  # muscles clamp it to 0..1
    activation: Annotated[np.ndarray, Layout(("N", "n"), 0.0, 1.0)]
    fiber_length: Annotated[np.ndarray, Layout(("N", "n"), 0.0, 10.0)]
    fiber_velocity: _PerMuscle
    tendon_force: _PerMuscle
    mtu_length: _PerMuscle  # of the whole path
    joint_moment: Annotated[np.ndarray, Layout(("N", "n", "n_q"))]  # of each muscle at each joint
    fiber_power: _PerMuscle
    tendon_power: _PerMuscle
    metabolic_power: _PerMuscle
    p_WH: _InWorld  # of the tip of the hand
    v_WH: _InWorld
    reward: Annotated[np.ndarray, Layout(("N",))]

    @property
    def muscle_torque(self) -> np.ndarray:
        """The generalized force (N, n_q), Nm, of all muscles on the joints."""
        return self.joint_moment.sum(axis=1)

    @property
    def hand_speed(self) -> np.ndarray:
        """(N,), m/s, of the tip of the hand."""
        return np.linalg.norm(self.v_WH, axis=1)

    def check(self, arm: Arm) -> None:
        """Raises RunFolderError if this is not a recording of the arm, or if its arrays do not fit each other."""
        problem = array_problem(self)
        if problem:
            raise RunFolderError(f"The recording has a wrong array: {problem}.")
        found, expected = (self.q.shape[1], self.activation.shape[1]), (len(arm.coordinates), len(arm.muscles))
        if found != expected:
            raise RunFolderError(
                f"The recording has {found[0]} joints and {found[1]} muscles: expected {expected[0]} and "
                f"{expected[1]}, as the arm {arm.name} has."
            )

    def save(self, file: Path) -> None:
        """Writes an .npz with one array per field. Raises StorageError if the file cannot be written."""
        save_arrays(self, file)

    @classmethod
    def load(cls, file: Path) -> "Recording":
        """Reads what `save` wrote. Raises RunFolderError if the file is missing or damaged, or is no recording."""
        loaded = load_arrays(cls, file)
        loaded._check_times(file)
        return loaded

    def _check_times(self, file: Path) -> None:
        start = max(0.0, CONTROL_STEP * round(self.t[0] / CONTROL_STEP))  # an episode may start later than at 0
        problem = time_problem(self.t, start)
        if problem:
            raise RunFolderError(f"{shown(file)}: {problem}.")


def save_recordings(recordings: Sequence[Recording], file: Path) -> None:
    """Writes recordings of the same length and arm into one .npz. Raises StorageError if it cannot be written."""
    save_stack(recordings, file)


def load_recordings(file: Path) -> list[Recording]:
    """Reads what `save_recordings` wrote. Raises RunFolderError as `Recording.load` does."""
    recordings = load_stack(Recording, file)
    for recording in recordings:
        recording._check_times(file)
    return recordings
