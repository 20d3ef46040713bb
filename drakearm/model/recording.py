"""A recording: the motion of an arm and its muscles in one closed-loop run, sampled at the control steps."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np

from drakearm.errors import RunFolderError, shown
from drakearm.files.arrays import Layout, load_arrays, save_arrays
from drakearm.model.arm import Arm
from drakearm.model.reference import CONTROL_STEP, time_problem

_LARGEST_ANGLE, _LARGEST_SPEED = 1e3, 1e6  # rad, rad/s: an arm that is out of control may turn fast
_Angles = Annotated[np.ndarray, Layout(("N", "n_q"), -_LARGEST_ANGLE, _LARGEST_ANGLE)]
_Speeds = Annotated[np.ndarray, Layout(("N", "n_q"), -_LARGEST_SPEED, _LARGEST_SPEED)]
_PerMuscle = Annotated[np.ndarray, Layout(("N", "n"))]


@dataclass(frozen=True)
class Recording:
    """Samples at times t (N,), in SI units and radians, of n_q joints and n muscles.

    q, v, reference_q, reference_v: (N, n_q). excitation, activation, fiber_length, fiber_velocity, tendon_force: (N,
    n). reward: (N,). The excitation of a sample was held during the control step that ends at the time of the sample.
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
    reward: Annotated[np.ndarray, Layout(("N",))]

    def check(self, arm: Arm) -> None:
        """Raises RunFolderError if this is not a recording of the arm."""
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
        start = max(0.0, CONTROL_STEP * round(loaded.t[0] / CONTROL_STEP))  # an episode may start later than at 0
        problem = time_problem(loaded.t, start)
        if problem:
            raise RunFolderError(f"{shown(file)}: {problem}.")
        return loaded
