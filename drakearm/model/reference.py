"""A reference movement: the desired motion of the joints, sampled at the control steps."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from pydrake.trajectories import PiecewisePolynomial

from drakearm.errors import RunFolderError, TaskError, shown
from drakearm.files.arrays import Layout, array_problem, load_arrays, save_arrays
from drakearm.model.arm import Arm
from drakearm.model.skeleton import movement_torques, skeleton_plant

CONTROL_STEP = 0.01  # s, between two samples of a reference, and between two decisions of a controller
_LONGEST = 20_000  # samples, 200 s
_DEGREE = 5  # of the spline through measured angles: its accelerations are smooth
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

    @classmethod
    def from_angles(cls, arm: Arm, t: np.ndarray, q: np.ndarray, load_mass: float = 0.0) -> "Reference":
        """The reference that has the measured joint angles q (N, n_q), rad, at times t (N,), s.

        The times rise, with any steps; the first one becomes 0. Between them a spline of degree 5 goes through all
        angles, and its derivatives are the speeds and accelerations. So noise must be filtered before: at 100 samples
        per second, noise of 1 mrad becomes accelerations of 50 rad/s^2. Torques are those of inverse
        dynamics, with load_mass (kg) in the hand. Raises TaskError for fewer than 6 samples, for times that do not
        rise, and as `check` does.
        """
        from scipy.interpolate import make_interp_spline  # not at the top, because it takes 0.7 s

        t, q = np.asarray(t, dtype=float), np.asarray(q, dtype=float)
        problem = _measured_problem(t, q, len(arm.coordinates))
        if problem:
            raise TaskError(f"The measured movement has no reference: {problem}.")
        spline = make_interp_spline(t - t[0], q, k=_DEGREE)
        samples = CONTROL_STEP * np.arange(int((t[-1] - t[0]) / CONTROL_STEP + 1e-6) + 1)
        angles, speeds, accelerations = (spline(samples, order) for order in range(3))
        torques = movement_torques(skeleton_plant(arm, load_mass), angles, speeds, accelerations)
        reference = cls(samples, angles, speeds, accelerations, torques)
        reference.check(arm)
        return reference

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


def _measured_problem(t: np.ndarray, q: np.ndarray, joints: int) -> str | None:
    """Why there is no spline through angles q at times t: found, expected. None if there is one."""
    if t.ndim != 1 or q.shape != (len(t), joints):
        return f"found t of the shape {t.shape} and q of the shape {q.shape}, expected (N,) and (N, {joints})"
    if len(t) <= _DEGREE:
        return f"found {len(t)} samples, expected at least {_DEGREE + 1}"
    if not (np.isfinite(t).all() and np.isfinite(q).all()):
        return "found numbers that are not finite, expected times in s and angles in rad"
    if not (np.diff(t) > 0.0).all():
        k = int(np.argmax(np.diff(t) <= 0.0)) + 1
        return f"t[{k}]: found {t[k]:g} after {t[k - 1]:g}, expected times that rise"
    if t[-1] - t[0] > CONTROL_STEP * _LONGEST:
        return f"found {t[-1] - t[0]:g} s, expected at most {CONTROL_STEP * _LONGEST:g} s"
    return None


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
