"""Centre-out reaching (figure 4 of the paper): eight targets around the hand, 10 cm away."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from drakearm.experiments import scenario_files
from drakearm.model.recording import Recording
from drakearm.reproduction.experiment import Experiment, all_methods, by_method, by_seed, common_rows
from drakearm.reproduction.hand import desired_path
from drakearm.reproduction.minimum_jerk import minimum_jerk_profile
from drakearm.reproduction.people import PEOPLE, load_people
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


def measure_reaches(outcomes: Sequence[Outcome]) -> dict[Method, list[Reaches]]:
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
        "the others is the ceiling. The hand paths are those of the first seed."
    )

    def trials(self, seeds: int) -> list[Trial]:
        return all_methods([name for name in scenario_files() if name.startswith("reach-")], seeds)

    def rows(self, outcomes: Sequence[Outcome]) -> list[Row]:
        measured = measure_reaches(outcomes)

        def per_run(measure: Callable[[Reach], float], digits: int) -> dict[Method, Spread]:
            return {
                method: Spread([[measure(run) for run in reaches.runs] for reaches in seeds], digits)
                for method, seeds in measured.items()
            }

        def per_seed(measure: Callable[[Reaches], float]) -> dict[Method, Spread]:
            return {method: Spread([[measure(reaches)] for reaches in seeds], 3) for method, seeds in measured.items()}

        success = {
            method: Share([[run.success for run in reaches.runs] for reaches in seeds])
            for method, seeds in measured.items()
        }
        jerk, people = minimum_jerk_profile(), [load_people(group) for group in PEOPLE]

        def compare(jerk_value: str, values: Sequence[str]) -> str:
            those = ", ".join(f"{value} ({p.label})" for p, value in zip(people, values, strict=True))
            return f"minimum jerk {jerk_value}; people {those}"

        shape = "hand-speed profile"
        return [
            Row("reaches that end within 10 % of the amplitude", success, "89 %"),
            Row("distance of the hand from the target at the end (cm)", per_run(lambda r: 100 * r.end_error, 2)),
            Row(
                "speed of the hand at the end (cm/s)", per_run(lambda r: 100 * r.recording.hand_speed[-1], 2), "at rest"
            ),
            Row(
                "mean, correlation with minimum jerk", per_seed(lambda r: correlation(r.mean, jerk.speed)), group=shape
            ),
            *(
                Row(
                    f"mean, correlation with people ({p.label})",
                    per_seed(lambda r, p=p: correlation(r.mean, p.mean)),
                    "0.91 (other people)",
                    f"ceiling {p.ceiling}; minimum jerk {correlation(jerk.speed, p.mean):.3f}",
                    shape,
                )
                for p in people
            ),
            *(
                Row(
                    f"standard deviation between runs, correlation with that within one person ({p.label})",
                    per_seed(lambda r, p=p: correlation(r.spread, p.within)),
                    "0.78 (other people)",
                    "minimum jerk has no deviation",
                    shape,
                )
                for p in people
            ),
            Row(
                "peak over mean",
                per_run(lambda r: r.profile.peak_over_mean, 2),
                note=compare(f"{jerk.peak_over_mean:.2f}", [f"{p.peak_over_mean:.2f}" for p in people]),
                group=shape,
            ),
            Row(
                "time of the peak (share of the duration)",
                per_run(lambda r: r.profile.time_of_peak, 3),
                note=compare(f"{jerk.time_of_peak:.2f}", [f"{p.time_of_peak:.3f}" for p in people]),
                group=shape,
            ),
            Row(
                "duration (s)",
                per_run(lambda r: r.profile.duration, 3),
                note="people " + ", ".join(f"{p.duration:.2f} ({p.label})" for p in people),
                group=shape,
            ),
            Row(
                "largest deviation of the path from a straight line, over its length",
                per_run(lambda r: r.path_deviation, 3),
                note="minimum jerk 0; people 0.11 (median of all trials)",
                group=shape,
            ),
            *common_rows(outcomes, "tracking and effort"),
        ]

    def figures(self, outcomes: Sequence[Outcome]) -> dict[str, Figure]:
        from drakearm.reproduction.figures.reaching import draw_reaching

        return {"fig4-reaching": draw_reaching(measure_reaches(outcomes))}
