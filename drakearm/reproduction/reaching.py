"""Centre-out reaching (figure 4 of the paper): eight targets around the hand, 10 cm away."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from drakearm.experiments import scenario_files
from drakearm.model.recording import Recording
from drakearm.reproduction.experiment import (
    Experiment,
    all_methods,
    by_method,
    by_seed,
    common_rows,
    noise_free,
    spreads,
)
from drakearm.reproduction.hand import desired_path
from drakearm.reproduction.minimum_jerk import minimum_jerk_profile
from drakearm.reproduction.people import PEOPLE, People, load_people
from drakearm.reproduction.rows import Row, Share, Spread
from drakearm.reproduction.speed_profile import SpeedProfile, correlation, path_deviation, speed_profile
from drakearm.reproduction.trial import Method, Outcome, Trial

TOLERANCE = 0.1  # of the amplitude: a reach that ends closer to its target is a success


@dataclass(frozen=True)
class Reach:
    """One noisy run."""

    recording: Recording
    start: np.ndarray  # (3,), m, where the reference has the hand at the start
    target: np.ndarray  # (3,), m, and at the end
    profile: SpeedProfile

    @property
    def end_error(self) -> float:
        """m"""
        return float(np.linalg.norm(self.recording.p_WH[-1] - self.target))

    @property
    def success(self) -> bool:
        return self.end_error < TOLERANCE * float(np.linalg.norm(self.target - self.start))

    @property
    def path_deviation(self) -> float:
        """Of the part of the path between onset and end, over its length."""
        t = self.recording.t
        return path_deviation(self.recording.p_WH[(t >= self.profile.onset) & (t <= self.profile.end)])


@dataclass(frozen=True)
class Reaches:
    """All noisy runs of one method with one seed: like the trials of one person."""

    runs: list[Reach]

    @property
    def mean(self) -> np.ndarray:
        """The mean speed profile (101,)."""
        return self._speeds.mean(axis=0)

    @property
    def spread(self) -> np.ndarray:
        """The standard deviation (101,) between the speed profiles."""
        return self._speeds.std(axis=0)

    @property
    def _speeds(self) -> np.ndarray:
        return np.array([run.profile.speed for run in self.runs])


Measured = dict[Method, list[Reaches]]  # for each method its seeds


def measure_reaches(outcomes: Sequence[Outcome]) -> Measured:
    """The reaches of each method, for each of its seeds."""

    def measure(outcome: Outcome) -> list[Reach]:
        path = desired_path(outcome.task)
        return [Reach(run, path[0], path[-1], speed_profile(run.t, run.hand_speed)) for run in outcome.noisy]

    return {
        method: [Reaches([run for outcome in seed for run in measure(outcome)]) for seed in by_seed(some)]
        for method, some in by_method(outcomes).items()
    }


class Reaching(Experiment):
    name = "reaching"
    title = "Centre-out reaching"
    text = (
        "The hand reaches from the middle to each of eight targets that are 10 cm away. Each movement has a policy of "
        "its own, which runs 10 times with noise. A speed profile is cut at 5 % of its peak. It is compared with the "
        "straight movement of least jerk (Flash and Hogan 1985) and with seven people. What one person reaches against "
        "the others is the ceiling. The paths of the hand are those of the first seed."
    )

    def trials(self, seeds: int) -> list[Trial]:
        return all_methods([name for name in scenario_files() if name.startswith("reach-")], seeds)

    def rows(self, outcomes: Sequence[Outcome]) -> list[Row]:
        measured = measure_reaches(outcomes)
        success = {
            method: Share([[run.success for run in reaches.runs] for reaches in seeds])
            for method, seeds in measured.items()
        }
        error, speed = (_per_run(measured, measure, 2) for measure in (_end_error_cm, _end_speed_cm))
        without_noise = spreads(outcomes, noise_free("hand_end_error_cm"), 2)
        return [
            Row("reaches that end within 10 % of the amplitude", success, "89 %"),
            Row("distance of the hand from the target at the end (cm)", error, note="with noise"),
            Row("distance of the hand from the target at the end (cm)", without_noise, note="without noise"),
            Row("speed of the hand at the end (cm/s)", speed, "at rest"),
            *_similarity_rows(measured),
            *_shape_rows(measured),
            *common_rows(outcomes, "tracking and effort"),
        ]

    def figures(self, outcomes: Sequence[Outcome]) -> dict[str, Figure]:
        from drakearm.reproduction.figures.reaching import draw_reaching

        return {"fig4-reaching": draw_reaching(measure_reaches(outcomes))}


def _end_error_cm(reach: Reach) -> float:
    return 100 * reach.end_error


def _end_speed_cm(reach: Reach) -> float:
    return 100 * float(reach.recording.hand_speed[-1])


def _similarity_rows(measured: Measured) -> list[Row]:
    """Correlations of the mean profile and of the spread, for each seed."""
    jerk, group = minimum_jerk_profile(), "hand-speed profile: similarity"

    def row(quantity: str, measure: Callable[[Reaches], float], paper: str = "", note: str = "") -> Row:
        values = {method: Spread([[measure(reaches)] for reaches in seeds], 3) for method, seeds in measured.items()}
        return Row(quantity, values, paper, note, group)

    def people_rows(people: People) -> list[Row]:
        ceiling = f"ceiling {people.ceiling}; minimum jerk {correlation(jerk.speed, people.mean):.3f}"
        return [
            row(
                f"mean, correlation with people ({people.label})",
                lambda reaches: correlation(reaches.mean, people.mean),
                "0.91 (other people)",
                ceiling,
            ),
            row(
                f"spread, correlation with that within one person ({people.label})",
                lambda reaches: correlation(reaches.spread, people.within),
                "0.78 (other people)",
                "standard deviation between runs; minimum jerk has none",
            ),
        ]

    return [
        row("mean, correlation with minimum jerk", lambda reaches: correlation(reaches.mean, jerk.speed)),
        *(row for group in PEOPLE for row in people_rows(load_people(group))),
    ]


def _shape_rows(measured: Measured) -> list[Row]:
    """Numbers of the single profiles, beside those of minimum jerk and of people."""
    jerk, everyone = minimum_jerk_profile(), [load_people(group) for group in PEOPLE]

    def row(quantity: str, measure: Callable[[Reach], float], digits: int, alike: str) -> Row:
        return Row(quantity, _per_run(measured, measure, digits), note=alike, group="hand-speed profile: shape")

    def of_people(measure: Callable[[People], float], digits: int) -> str:
        return "people " + ", ".join(f"{measure(people):.{digits}f} ({people.label})" for people in everyone)

    return [
        row(
            "peak over mean",
            lambda reach: reach.profile.peak_over_mean,
            2,
            f"minimum jerk {jerk.peak_over_mean:.2f}; {of_people(lambda people: people.peak_over_mean, 2)}",
        ),
        row(
            "time of the peak (share of the duration)",
            lambda reach: reach.profile.time_of_peak,
            3,
            f"minimum jerk {jerk.time_of_peak:.2f}; {of_people(lambda people: people.time_of_peak, 3)}",
        ),
        row("duration (s)", lambda reach: reach.profile.duration, 3, of_people(lambda people: people.duration, 2)),
        row(
            "largest deviation of the path from a straight line, over its length",
            lambda reach: reach.path_deviation,
            3,
            "minimum jerk 0; people 0.11 (median of all trials)",
        ),
    ]


def _per_run(measured: Measured, measure: Callable[[Reach], float], digits: int) -> dict[Method, Spread]:
    return {
        method: Spread([[measure(run) for run in reaches.runs] for reaches in seeds], digits)
        for method, seeds in measured.items()
    }
