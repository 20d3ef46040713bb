"""The results of experiments as plain content: results.json, from which the report and docs/results.md are made."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drakearm.experiments.metrics import versions
from drakearm.reproduction.experiment import Experiment, by_method
from drakearm.reproduction.page import Table
from drakearm.reproduction.rows import Row
from drakearm.reproduction.trial import Outcome


def outcomes_of(experiment: Experiment, outcomes: Sequence[Outcome]) -> list[Outcome]:
    """The outcomes that belong to an experiment, in the order of its trials."""
    if not outcomes:
        return []
    found = {outcome.trial: outcome for outcome in outcomes}
    trials = experiment.trials(1 + max(trial.seed for trial in found))
    return [found[trial] for trial in trials if trial in found]


def collect_results(
    experiments: Sequence[Experiment], outcomes: Sequence[Outcome], command: str, tables: Sequence[Table] = ()
) -> dict[str, Any]:
    """The tables of the experiments that have outcomes, the seconds that they took, and further tables.

    command: that made them.
    """
    found = [(experiment, outcomes_of(experiment, outcomes)) for experiment in experiments]
    return {
        "command": command,
        "versions": versions(),
        "experiments": {
            experiment.name: {
                "title": experiment.title,
                "text": experiment.text,
                "seeds": len({outcome.trial.seed for outcome in some}),
                "movements": len({outcome.trial.scenario for outcome in some}),
                "rows": [_row(row) for row in experiment.rows(some) if row.values],
                "seconds": {str(method): _seconds(trials) for method, trials in by_method(some).items()},
            }
            for experiment, some in found
            if some
        },
        "tables": [table.content for table in tables],
    }


def _row(row: Row) -> dict[str, Any]:
    values = {str(method): {"text": str(value), **value.content} for method, value in row.values.items()}
    return {"group": row.group, "quantity": row.quantity, "note": row.note, "paper": row.paper, "values": values}


def _seconds(outcomes: Sequence[Outcome]) -> Mapping[str, dict[str, float]]:
    """How long each part took for one trial, mean and largest."""
    parts = {part: [outcome.seconds[part] for outcome in outcomes] for part in outcomes[0].seconds}
    return {part: {"mean": float(np.mean(taken)), "largest": max(taken)} for part, taken in parts.items()}
