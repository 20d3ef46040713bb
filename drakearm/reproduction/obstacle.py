"""Obstacle avoidance (figure 9 of the paper): a bar in the way of the hand, and the same movement without it."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from drakearm.experiments import load_scenario
from drakearm.model import Arm, MakeTorqueArm
from drakearm.model.clearance import Clearance
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
from drakearm.reproduction.rows import Row, Share
from drakearm.reproduction.trial import Outcome, Trial

WITH, WITHOUT = "obstacle", "no-obstacle"
GOAL = 0.02  # rad: a movement whose joints end closer to their targets has reached its goal


class Bar:
    """The bar of the scenario `obstacle`, and how far an arm is from it."""

    def __init__(self, arm: Arm):
        scenario = load_scenario(WITH)
        assert scenario.obstacle is not None
        self.obstacle = scenario.obstacle
        self._clearance = Clearance(MakeTorqueArm(arm), arm, scenario.obstacle)

    def clearance(self, run: Recording) -> tuple[np.ndarray, np.ndarray]:
        """Times (n,), s, and the distances (n, parts), m, of the arm's parts then: see `Clearance.along`."""
        return self._clearance.along(run.t, run.q, run.v)


class ObstacleAvoidance(Experiment):
    name = "obstacle"
    title = "Obstacle avoidance"
    text = (
        "The target switches from 22.5 to 90 degrees while a bar is in the way. The movement runs 10 times with noise, "
        "and so does the same movement without the bar. The clearance is that of hand, wrist and forearm, every "
        "millisecond of every run. It is negative where a part of the arm would be inside the bar."
    )

    def trials(self, seeds: int) -> list[Trial]:
        return all_methods([WITH, WITHOUT], seeds)

    def rows(self, outcomes: Sequence[Outcome]) -> list[Row]:
        bar = Bar(outcomes[0].task.arm)

        def smallest(outcome: Outcome, run: Recording) -> float:
            return 100 * float(bar.clearance(run)[1].min())

        rows = []
        for name, some in by_scenario(outcomes).items():
            group = "with the bar" if name == WITH else "the movement that does not know of the bar"
            clearance = spreads(some, noisy(smallest), 2)
            free = {
                method: Share([[cm > 0 for cm in runs] for runs in found.seeds]) for method, found in clearance.items()
            }
            reached = shares(some, noisy(lambda o, run: end_error(run) < GOAL))
            rows += [
                Row("runs without contact", free, "goes round it" if name == WITH else "", group=group),
                Row("smallest clearance (cm)", clearance, group=group),
                Row(f"goal reached: both joints end within {GOAL} rad", reached, "reached", group=group),
                Row(
                    "error at the end (rad)",
                    spreads(some, noisy(lambda o, run: end_error(run)), 4),
                    note="worse joint",
                    group=group,
                ),
            ]
        return [*rows, *common_rows(outcomes, "tracking and effort")]

    def figures(self, outcomes: Sequence[Outcome]) -> dict[str, Figure]:
        from drakearm.reproduction.figures.obstacle import draw_obstacle

        return {"fig9-obstacle": draw_obstacle(outcomes, Bar(outcomes[0].task.arm))}
