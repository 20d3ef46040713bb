"""A reference movement: what the joints should do, sampled at the control steps."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydrake.trajectories import PiecewisePolynomial

from drakearm.model.arrays import load_arrays, save_arrays

CONTROL_STEP = 0.01  # s, between two samples and between two decisions of a controller


@dataclass(frozen=True)
class Reference:
    """Joint angles q, speeds v, accelerations a and torques tau, each (N, n_q), at times t (N,); SI."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    tau: np.ndarray

    @property
    def duration(self) -> float:
        return float(self.t[-1])

    def trajectory(self) -> PiecewisePolynomial:
        """q(t) as a cubic spline through the sampled angles and speeds."""
        return PiecewisePolynomial.CubicHermite(self.t, self.q.T, self.v.T)

    def preview(self, lookahead: tuple[int, ...] = (0,)) -> np.ndarray:
        """Samples (N, 2 n_q len(lookahead)): q at every lookahead (in control steps), then v; at rest after the end."""
        at = np.minimum(np.arange(len(self.t))[:, None] + np.array(lookahead), len(self.t) - 1)
        return np.hstack([self.q[at].reshape(len(at), -1), self.v[at].reshape(len(at), -1)])

    def preview_trajectory(self, lookahead: tuple[int, ...] = (0,)) -> PiecewisePolynomial:
        """The q half of `preview` as a trajectory; its first derivative is the v half."""
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
    """Rows of each arm's first and last sample, (N,), where the samples of several references follow each other.

    lengths: numbers of samples of the references. task_of_arm: the index of each arm's reference, (N,).
    """
    last = np.cumsum(lengths)[task_of_arm] - 1
    return last - lengths[task_of_arm] + 1, last
