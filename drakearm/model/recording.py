"""A recording: what the arm did during one closed-loop run, sampled at the control steps."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drakearm.model.arrays import load_arrays, save_arrays


@dataclass(frozen=True)
class Recording:
    """Times t (N,) and at each of them, in SI and radians, n muscles and n_q joints: what the field names say.

    q, v, reference_q, reference_v: (N, n_q). excitation, activation, fiber_length, fiber_velocity, tendon_force: (N,
    n). reward: (N,). The excitation at a time is the one that was held until then, in the control step that ends there.
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
        """Writes an .npz with one array a field."""
        save_arrays(self, file)

    @classmethod
    def load(cls, file: Path) -> "Recording":
        """Reads what `save` wrote. Raises RunFolderError if the file is missing or lacks an array."""
        return load_arrays(cls, file)
