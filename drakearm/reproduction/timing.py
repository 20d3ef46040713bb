"""Precise timing (figures 5 and 6 of the paper): the elbow bends in a given time, and the upper arm stays still."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.figure import Figure

from drakearm.experiments import scenario_files
from drakearm.model.recording import Recording
from drakearm.reproduction.experiment import (
    Experiment,
    all_methods,
    by_scenario,
    common_rows,
    end_error,
    noisy,
    shares,
    spreads,
)
from drakearm.reproduction.rows import Row
from drakearm.reproduction.trial import Outcome, Trial

LEARNED = 0.1  # rad: the error below which the paper calls a movement learned
_STRICT = 0.05  # rad
_STRAYS = {"timing-0.4s": "0.2", "timing-0.7s": "0.1"}  # rad, in the paper


def batches_to_learn(error: np.ndarray) -> int:
    """After how many batches the error (n,), rad, of a training stays below `LEARNED`; n if it never does."""
    above = np.flatnonzero(~(error < LEARNED))
    return int(above[-1]) + 1 if above.size else 0


class Timing(Experiment):
    name = "timing"
    title = "Precise timing"
    text = (
        "The elbow bends from 0 to 90 degrees in 0.4, 0.5, 0.6 or 0.7 s while the upper arm stays still. Each movement "
        "runs 10 times with noise and 12 times with the perturbations of its scenario file: of the starting posture, "
        "of the activations at the start, and of the excitations."
    )

    def trials(self, seeds: int) -> list[Trial]:
        return all_methods([name for name in scenario_files() if name.startswith("timing-")], seeds)

    def rows(self, outcomes: Sequence[Outcome]) -> list[Row]:
        def perturbed(limit: float) -> Callable[[Outcome], list[bool]]:
            return lambda outcome: [end_error(run) < limit for run in outcome.perturbed]

        robust = "perturbed runs"
        return [
            Row(
                f"error at the end below {LEARNED} rad", shares(outcomes, perturbed(LEARNED)), "44 of 48", group=robust
            ),
            Row(f"error at the end below {_STRICT} rad", shares(outcomes, perturbed(_STRICT)), group=robust),
            *(row for name, some in by_scenario(outcomes).items() for row in _movement_rows(name, some)),
            Row(
                f"batches until the error stays below {LEARNED} rad",
                spreads(outcomes, _batches, 0),
                "about 150 of 200",
                "0: from the first batch on, after imitation",
                "learning",
            ),
            *common_rows(outcomes, "tracking and effort"),
        ]

    def figures(self, outcomes: Sequence[Outcome]) -> dict[str, Figure]:
        from drakearm.reproduction.figures.timing import draw_learning, draw_timing

        figures = {"fig5-timing": draw_timing(by_scenario(outcomes))}
        learning = [outcome for outcome in outcomes if outcome.learning_curve is not None]
        return figures | ({"fig6-learning": draw_learning(by_scenario(learning))} if learning else {})


def _batches(outcome: Outcome) -> list[float]:
    return [] if outcome.learning_curve is None else [batches_to_learn(outcome.learning_curve["tracking_error"])]


def _movement_rows(name: str, outcomes: Sequence[Outcome]) -> list[Row]:
    shoulder = outcomes[0].task.arm.coordinates.index("shoulder")

    def strays(outcome: Outcome, run: Recording) -> float:
        return float(np.abs(run.q - run.reference_q)[:, shoulder].max())

    note = "with noise"
    return [
        Row(
            "error at the end (rad)",
            spreads(outcomes, noisy(lambda o, run: end_error(run)), 4),
            "about 0.04",
            note,
            name,
        ),
        Row(
            "error at the end (rad)",
            spreads(outcomes, lambda o: [end_error(o.noise_free)], 4),
            "",
            "without noise",
            name,
        ),
        Row("the shoulder strays (rad)", spreads(outcomes, noisy(strays), 4), _STRAYS.get(name, ""), note, name),
    ]
