"""A reference movement: the desired motion of the joints, sampled at the control steps."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydrake.trajectories import PiecewisePolynomial

from drakearm.files.arrays import load_arrays, save_arrays

CONTROL_STEP = 0.01  # s, between two samples of a reference, and between two decisions of a controller


@dataclass(frozen=True)
class Reference:
    """Joint angles q, speeds v, accelerations a and torques tau, each (N, n_q), at times t (N,), in SI and radians."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    tau: np.ndarray

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
        """Writes an .npz with the arrays t, q, v, a, tau."""
        save_arrays(self, file)

    @classmethod
    def load(cls, file: Path) -> "Reference":
        """Reads what `save` wrote. Raises RunFolderError if the file is missing or lacks an array."""
        return load_arrays(cls, file)


def sample_ranges(lengths: np.ndarray, task_of_arm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and last row (N,) of each arm's reference, in an array of all references, one below the other.

    lengths: number of samples of each reference. task_of_arm (N,): index of each arm's reference.
    """
    last = np.cumsum(lengths)[task_of_arm] - 1
    return last - lengths[task_of_arm] + 1, last
