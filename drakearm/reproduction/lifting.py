"""Weight lifting (figures 7 and 8 of the paper): the timed movement with a weight in the hand."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from drakearm.model.recording import Recording
from drakearm.model.static_optimization import NEGLIGIBLE
from drakearm.reproduction.experiment import (
    Experiment,
    all_methods,
    by_scenario,
    common_rows,
    noisy,
    shares,
    spreads,
    with_noise,
)
from drakearm.reproduction.muscle_load import muscle_groups, muscle_load
from drakearm.reproduction.rows import Row
from drakearm.reproduction.trial import Outcome, Trial

LOADS = (1, 2, 5, 10, 20)  # kg
LIFTED = 0.1  # rad: a joint follows the plan if its error is smaller, in the mean and at the end


@dataclass(frozen=True)
class Weighting:
    """How the reward weighs the errors of shoulder and elbow, and the endings of the scenarios' names with it."""

    label: str
    ending: str

    def scenario(self, load: int) -> str:
        return f"lift-{load}kg{self.ending}"


WEIGHTINGS = (
    Weighting("elbow and shoulder weighted (1, 1)", ""),
    Weighting("elbow and shoulder weighted (1, 0.2)", "-elbow"),
)


def flexor_load(outcome: Outcome, run: Recording) -> float:
    """The muscle load of the elbow's flexors in a run."""
    return _loads(outcome, run)[0]


def extensor_load(outcome: Outcome, run: Recording) -> float:
    """The muscle load of the elbow's extensors in a run."""
    return _loads(outcome, run)[1]


def lacking_torque(outcome: Outcome) -> str:
    """What static strength predicts."""
    found = outcome.feasibility
    if found.feasible:
        return f"the muscles are strong enough: activations up to {found.activation.max():.2f}"
    lacking = zip(found.coordinates, np.abs(found.reserve).max(axis=0), strict=True)
    return "the muscles lack " + ", ".join(f"{tau:.1f} Nm at the {joint}" for joint, tau in lacking if tau > NEGLIGIBLE)


class Lifting(Experiment):
    name = "lifting"
    title = "Weight lifting"
    text = (
        "The elbow bends by 90 degrees in 0.7 s with 1, 2, 5, 10 or 20 kg in the hand, 10 times with noise. The reward "
        "weighs both joints alike, or the shoulder by 0.2. The muscle load is the share of the time that a muscle is "
        "active above 80 %, mean over the flexors or the extensors of the elbow. 2 kg lie at the limit of strength: "
        "static optimization needs full activation. Where muscles lack torque, no excitations can follow the plan."
    )

    def trials(self, seeds: int) -> list[Trial]:
        return all_methods([weighting.scenario(load) for weighting in WEIGHTINGS for load in LOADS], seeds)

    def rows(self, outcomes: Sequence[Outcome]) -> list[Row]:
        movements = by_scenario(outcomes)
        found = [
            (weighting, load, movements[weighting.scenario(load)])
            for weighting in WEIGHTINGS
            for load in LOADS
            if weighting.scenario(load) in movements
        ]
        rows = [row for weighting, load, some in found for row in _movement_rows(weighting, load, some)]
        return [*rows, *common_rows(outcomes, "tracking and effort, all loads")]

    def figures(self, outcomes: Sequence[Outcome]) -> dict[str, Figure]:
        from drakearm.reproduction.figures.lifting import draw_activations, draw_lifting, draw_muscle_load

        movements = by_scenario(outcomes)
        return {
            "fig7-lifting": draw_lifting(movements),
            "fig8-muscle-load": draw_muscle_load(movements),
            "fig8-activations": draw_activations(movements),
        }


def _movement_rows(weighting: Weighting, load: int, outcomes: Sequence[Outcome]) -> list[Row]:
    joints = outcomes[0].task.arm.coordinates
    elbow = joints.index("elbow")

    def ends(outcome: Outcome, run: Recording) -> bool:
        return bool(np.abs(run.q - run.reference_q)[-1, elbow] < LIFTED)

    def follows(outcome: Outcome, run: Recording) -> np.ndarray:
        """Whether each joint follows the plan, (n_q,)."""
        error = np.abs(run.q - run.reference_q)
        return (error.mean(axis=0) < LIFTED) & (error[-1] < LIFTED)

    group = f"{load} kg, {weighting.label}: {lacking_torque(outcomes[0])}"
    elbow_follows = shares(outcomes, noisy(lambda o, run: bool(follows(o, run)[elbow])))
    both_follow = shares(outcomes, noisy(lambda o, run: bool(follows(o, run).all())))
    paper = "lifts up to about 5 kg"
    return [
        Row(f"the elbow ends within {LIFTED} rad of its target", shares(outcomes, noisy(ends)), paper, group=group),
        Row(f"and its mean error is below {LIFTED} rad", elbow_follows, group=group),
        Row("and so are both errors of the shoulder", both_follow, group=group),
        *(
            Row(f"error of the {joint} at the end (rad)", spreads(outcomes, with_noise("end_error", j)), group=group)
            for j, joint in enumerate(joints)
        ),
        Row("muscle load of the flexors (share of the time)", spreads(outcomes, noisy(flexor_load), 2), group=group),
        Row("muscle load of the extensors", spreads(outcomes, noisy(extensor_load), 2), group=group),
    ]


def _loads(outcome: Outcome, run: Recording) -> tuple[float, float]:
    arm = outcome.task.arm
    groups = muscle_groups(arm, arm.coordinates.index("elbow"), outcome.task.reference.q)
    return muscle_load(run, groups.flexors), muscle_load(run, groups.extensors)
