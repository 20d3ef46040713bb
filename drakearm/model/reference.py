"""A reference movement: the desired motion of the joints, sampled at the control steps."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from pydrake.trajectories import PiecewisePolynomial

from drakearm.errors import RunFolderError, TaskError, shown
from drakearm.files.arrays import Layout, array_problem, load_arrays, save_arrays
from drakearm.model.arm import Arm

CONTROL_STEP = 0.01  # s, between two samples of a reference, and between two decisions of a controller
_LONGEST = 20_000  # samples, 200 s
_PER_JOINT = ("N", "n_q")
_Angles = Annotated[np.ndarray, Layout(_PER_JOINT, -10.0, 10.0)]  # rad: more than any joint of an arm turns
_Speeds = Annotated[np.ndarray, Layout(_PER_JOINT, -1e3, 1e3)]  # rad/s: arms reach 30


@dataclass(frozen=True)
class Reference:
    """Joint angles q, speeds v, accelerations a and torques tau, each (N, n_q), at times t (N,), in SI and radians.

    The times begin at 0 and are CONTROL_STEP apart.
    """

    t: Annotated[np.ndarray, Layout(("N",))]
    q: _Angles
    v: _Speeds
    a: Annotated[np.ndarray, Layout(_PER_JOINT, -1e6, 1e6)]
    tau: Annotated[np.ndarray, Layout(_PER_JOINT, -1e9, 1e9)]

    @property
    def duration(self) -> float:
        """s, the time of the last sample."""
        return float(self.t[-1])

    def trajectory(self) -> PiecewisePolynomial:
        """q(t) as a cubic spline through the sampled angles and speeds."""
        return PiecewisePolynomial.CubicHermite(self.t, self.q.T, self.v.T)

    def preview(self, lookahead: tuple[int, ...] = (0,)) -> np.ndarray:
        """What lies ahead of each sample: q, then v, at every lookahead (in control steps); (N, 2 n_q len(lookahead)).

        A lookahead beyond the end gives the last sample.
        """
        at = np.minimum(np.arange(len(self.t))[:, None] + np.array(lookahead), len(self.t) - 1)
        return np.hstack([self.q[at].reshape(len(at), -1), self.v[at].reshape(len(at), -1)])

    def preview_trajectory(self, lookahead: tuple[int, ...] = (0,)) -> PiecewisePolynomial:
        """The first half of `preview` (q) as a trajectory over time; its first derivative is the second half (v)."""
        samples = self.preview(lookahead)
        half = samples.shape[1] // 2
        return PiecewisePolynomial.CubicHermite(self.t, samples[:, :half].T, samples[:, half:].T)

    def save(self, file: Path) -> None:
        """Writes an .npz with the arrays t, q, v, a, tau. Raises StorageError if the file cannot be written."""
        save_arrays(self, file)

    @classmethod
    def load(cls, file: Path) -> "Reference":
        """Reads what `save` wrote. Raises RunFolderError if the file is missing or damaged, or is no reference."""
        loaded = load_arrays(cls, file)
        problem = loaded.problem()
        if problem:
            raise RunFolderError(f"{shown(file)}: {problem}.")
        return loaded

    def problem(self) -> str | None:
        """Why an arm cannot follow this reference: array, found, expected. None if it can. Torques do not matter."""
        return array_problem(self, ("t", "q", "v", "a")) or time_problem(self.t, 0.0)

    def check(self, arm: Arm) -> None:
        """Raises TaskError, which names the array or the number of joints, if this is not a reference for the arm."""
        problem = self.problem()
        if problem:
            raise TaskError(f"The arm {arm.name} cannot follow the reference: {problem}.")
        joints, coordinates = np.shape(self.q)[1], arm.coordinates
        if joints != len(coordinates):
            raise TaskError(
                f"The reference has {joints} joints: expected {len(coordinates)}, the {', '.join(coordinates)} of the "
                f"arm {arm.name}."
            )


def time_problem(t: np.ndarray, start: float) -> str | None:
    """Why t (N,), s, are not the times of samples from `start` on: found, expected. None if they are."""
    if not 2 <= len(t) <= _LONGEST:
        return f"t: found N = {len(t)}, expected N = 2 to {_LONGEST}"
    expected = start + CONTROL_STEP * np.arange(len(t))
    wrong = np.abs(t - expected) > 1e-6
    if wrong.any():
        k = int(np.argmax(wrong))
        return f"t[{k}]: found {t[k]:g}, expected {expected[k]:g}, because samples are {CONTROL_STEP} s apart"
    return None


def sample_ranges(lengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and last row (N,) of each reference in an array of all references, one below the other.

    lengths: number of samples of each reference.
    """
    last = np.cumsum(lengths) - 1
    return last - lengths + 1, last
