"""The seam for experiments: which trials one consists of, and how its outcomes are shown."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

import numpy as np
from matplotlib.figure import Figure

from drakearm.model.recording import Recording
from drakearm.reproduction.rows import Row, Share, Spread
from drakearm.reproduction.trial import Method, Outcome, Trial

_T = TypeVar("_T")


class Experiment(ABC):
    """Base of all experiments. `rows` and `figures` get outcomes that may lack methods and seeds, but no movements."""

    name: str  # on the command line and in results.json
    title: str
    text: str  # what is done, and what to look at

    @abstractmethod
    def trials(self, seeds: int) -> list[Trial]:
        """What to run, with this many seeds of each method that learns."""

    @abstractmethod
    def rows(self, outcomes: Sequence[Outcome]) -> list[Row]:
        """The table of the experiment. A row without values is left out."""

    def figures(self, outcomes: Sequence[Outcome]) -> dict[str, Figure]:
        """The pictures of the experiment, by the names of their files without an ending; by default there are none."""
        return {}


def all_methods(scenarios: Sequence[str], seeds: int) -> list[Trial]:
    """Trials of some movements by all methods; static optimization does not learn and needs one seed only."""
    return [
        Trial(scenario, method, seed)
        for seed in range(seeds)
        for method in Method
        if method is not Method.static or seed == 0
        for scenario in scenarios
    ]


def by_method(outcomes: Sequence[Outcome]) -> dict[Method, list[Outcome]]:
    """The outcomes of each method that has some, in the order of `Method`."""
    found = {method: [outcome for outcome in outcomes if outcome.trial.method is method] for method in Method}
    return {method: some for method, some in found.items() if some}


def by_seed(outcomes: Sequence[Outcome]) -> list[list[Outcome]]:
    """The outcomes of each seed."""
    seeds = sorted({outcome.trial.seed for outcome in outcomes})
    return [[outcome for outcome in outcomes if outcome.trial.seed == seed] for seed in seeds]


def by_scenario(outcomes: Sequence[Outcome]) -> dict[str, list[Outcome]]:
    """The outcomes of each movement, in the order of the outcomes."""
    names = dict.fromkeys(outcome.trial.scenario for outcome in outcomes)
    return {name: [outcome for outcome in outcomes if outcome.trial.scenario == name] for name in names}


def spreads(
    outcomes: Sequence[Outcome], measure: Callable[[Outcome], Sequence[float]], digits: int = 3
) -> dict[Method, Spread]:
    """A measure of the runs of an outcome, collected for each method."""
    return {method: Spread(values, digits) for method, values in _collect(outcomes, measure)}


def shares(outcomes: Sequence[Outcome], measure: Callable[[Outcome], Sequence[bool]]) -> dict[Method, Share]:
    """How many runs of each method have a property."""
    return {method: Share(values) for method, values in _collect(outcomes, measure)}


def noisy(measure: Callable[[Outcome, Recording], _T]) -> Callable[[Outcome], list[_T]]:
    """The measure of an outcome that measures each of its noisy runs."""
    return lambda outcome: [measure(outcome, run) for run in outcome.noisy]


def end_error(run: Recording) -> float:
    """rad, of the joint with the larger error at the end."""
    return float(np.abs(run.q[-1] - run.reference_q[-1]).max())


def _collect(
    outcomes: Sequence[Outcome], measure: Callable[[Outcome], Sequence[_T]]
) -> Iterator[tuple[Method, list[list[_T]]]]:
    """For each method that was measured, for each of its seeds, the measures of all runs."""
    for method, some in by_method(outcomes).items():
        seeds = [[value for outcome in seed for value in measure(outcome)] for seed in by_seed(some)]
        if any(seeds):
            yield method, seeds


def with_noise(name: str, joint: int | None = None) -> Callable[[Outcome], list[float]]:
    """The measure that takes a quantity of the noisy runs from metrics.json, of one joint if it has one per joint."""
    return lambda outcome: [_of_joint(value, joint) for value in outcome.metrics["noisy"][name]]


def noise_free(name: str, joint: int | None = None) -> Callable[[Outcome], list[float]]:
    """The same of the run without noise."""
    return lambda outcome: [_of_joint(outcome.metrics["noise_free"][name], joint)]


def _of_joint(value: Any, joint: int | None) -> float:
    return value if joint is None else value[joint]


def common_rows(outcomes: Sequence[Outcome], group: str) -> list[Row]:
    """What every experiment reports: tracking errors and effort."""

    def error(joint: int, name: str, measure: Callable[..., Any], note: str) -> Row:
        values = spreads(outcomes, measure("tracking_error_mean", joint), 4)
        return Row(f"mean tracking error of the {name} (rad)", values, "about 0.05", note, group)

    joints = list(enumerate(outcomes[0].task.arm.coordinates))
    activation = spreads(outcomes, with_noise("squared_activation"))
    energy = spreads(outcomes, with_noise("metabolic_energy"), 1)
    return [
        *(error(j, joint, with_noise, "with noise") for j, joint in joints),
        *(error(j, joint, noise_free, "without noise") for j, joint in joints),
        Row("sum of squared activations (s)", activation, note="integral over the time", group=group),
        Row("metabolic energy (J)", energy, note="of all muscles", group=group),
    ]
