"""Speed profiles of the hand: the speed of one movement over its peak, against the time over its duration."""

from dataclasses import dataclass

import numpy as np

CUT = 0.05  # of the peak: below this speed the movement has not begun yet, or has ended
PHASES = np.linspace(0.0, 1.0, 101)


@dataclass(frozen=True)
class SpeedProfile:
    """One movement, from its onset to its end: where the speed rises above and falls below `CUT` of its peak."""

    onset: float  # s
    end: float  # s
    speed: np.ndarray  # (101,) at PHASES, over the peak
    peak_over_mean: float
    time_of_peak: float  # share of the duration, from the onset

    @property
    def duration(self) -> float:
        """s"""
        return self.end - self.onset


def speed_profile(t: np.ndarray, speed: np.ndarray) -> SpeedProfile:
    """Cuts and resamples the speed (N,), m/s, of a hand at times t (N,), s, linearly between the samples.

    The movement is the part around the peak where the speed stays above `CUT` of it. A hand that does not slow down so
    far begins with the first sample, or ends with the last one.
    """
    peak = int(speed.argmax())
    slow = CUT * speed[peak]
    before, after = np.flatnonzero(speed[:peak] < slow), np.flatnonzero(speed[peak:] < slow)
    onset = _crossing(t, speed, before[-1], slow) if before.size else t[0]
    end = _crossing(t, speed, peak + after[0] - 1, slow) if after.size else t[-1]
    resampled = np.interp(onset + PHASES * (end - onset), t, speed)
    return SpeedProfile(
        onset=float(onset),
        end=float(end),
        speed=resampled / speed[peak],
        peak_over_mean=float(speed[peak] / _mean(resampled)),
        time_of_peak=float((t[peak] - onset) / (end - onset)),
    )


def correlation(a: np.ndarray, b: np.ndarray) -> float:
    """Pearson's correlation of two curves that are sampled at the same phases."""
    return float(np.corrcoef(a, b)[0, 1])


def path_deviation(p: np.ndarray) -> float:
    """The largest distance of a path (N, 3) from the straight line through its ends, over the distance of the ends."""
    way = p[-1] - p[0]
    aside = np.linalg.norm(np.cross(p - p[0], way), axis=1) / np.linalg.norm(way)
    return float(aside.max() / np.linalg.norm(way))


def _crossing(t: np.ndarray, speed: np.ndarray, k: int, level: float) -> float:
    """The time between samples k and k + 1 at which the speed is at a level."""
    share = (level - speed[k]) / (speed[k + 1] - speed[k])
    return float(t[k] + share * (t[k + 1] - t[k]))


def _mean(speed: np.ndarray) -> float:
    return float(np.trapezoid(speed, PHASES))
