"""A recording: the motion of an arm and its muscles in one closed-loop run, sampled at the control steps."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drakearm.files.arrays import load_arrays, save_arrays


@dataclass(frozen=True)
class Recording:
    """Samples at times t (N,), in SI units and radians, of n_q joints and n muscles.

    q, v, reference_q, reference_v: (N, n_q). excitation, activation, fiber_length, fiber_velocity, tendon_force: (N,
    n). reward: (N,). The excitation of a sample was held during the control step that ends at the time of the sample.
    """

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    reference_q: np.ndarray
    reference_v: np.ndarray
    excitation: np.ndarray
    activation: np.ndarray
    fiber_length: np.ndarray
    fiber_velocity: np.ndarray
    tendon_force: np.ndarray
    reward: np.ndarray

    def save(self, file: Path) -> None:
        """Writes an .npz with one array per field."""
        save_arrays(self, file)

    @classmethod
    def load(cls, file: Path) -> "Recording":
        """Reads what `save` wrote. Raises RunFolderError if the file is missing or lacks an array."""
        return load_arrays(cls, file)
