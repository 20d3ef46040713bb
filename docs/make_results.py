"""Writes docs/results.md from the numbers of a reproduction of the paper's experiments.

`drakearm reproduce all` writes them into a file, results.json; then `python docs/make_results.py FILE` writes the page,
and keeps the numbers beside it in docs/results.json.
`--quick` only checks that it works: it prints the page of one movement, by static optimization.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np

from drakearm.diagrams import MakeStaticLoop
from drakearm.experiments import load_scenario
from drakearm.experiments.metrics import evaluation_metrics
from drakearm.model import load_arm
from drakearm.planning import muscle_feasibility, plan
from drakearm.reproduction.catalog import EXPERIMENTS
from drakearm.reproduction.results import collect_results
from drakearm.reproduction.trial import Method, Outcome, Trial

PAGE = Path(__file__).parent / "results.md"
NUMBERS = PAGE.with_suffix(".json")

_HEAD = """# The paper's experiments, reproduced
Made by `{command}` and `python docs/make_results.py`, with
{versions}.

All runs are simulations of the arm's Drake Diagram. *Static optimization* (computed muscle control) does not learn.
*PPO alone* learns as in the paper: 28 observations, random weights, no teacher. The *default* is described in
[learning.md](learning.md). A value is the mean ± the standard deviation over all runs with noise; with several seeds,
the standard deviation between the seeds' means follows. The paper is Denizdurduran, Markram and Gewaltig, Biological
Cybernetics 116, 2022. The people are seven persons of HuG-MP
([credits](../drakearm/reproduction/hug_mp/CREDITS.md)), and not those with whom the paper compares.
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path, nargs="?", help="the results.json of a reproduction")
    parser.add_argument("--quick", action="store_true", help="prints the page of one movement")
    options = parser.parse_args()
    if options.quick:
        print(page(quick_results()))
    elif options.file is None:
        parser.error("expected the results.json of a reproduction, or --quick")
    else:
        numbers = options.file.read_text(encoding="utf-8")
        PAGE.write_text(page(json.loads(numbers)), encoding="utf-8")
        NUMBERS.write_text(numbers, encoding="utf-8")
        print(f"wrote {PAGE}")


def page(results: Mapping[str, Any]) -> str:
    """The page, as Markdown: a section per experiment, a table per group of its rows, and the further tables."""
    versions = ", ".join(f"{name} {number}" for name, number in results["versions"].items())
    parts = [_HEAD.format(command=results["command"], versions=versions)]
    for experiment in results["experiments"].values():
        parts.append(f"## {experiment['title']}\n{fill(experiment['text'], 120)}\n")
        for group, found in groupby(experiment["rows"], key=lambda row: row["group"]):
            rows = [[with_note(row["quantity"], row["note"]), row["paper"], *texts(row)] for row in found]
            heading = [f"**{group}**\n"] if group else []
            parts += [*heading, markdown(["quantity", "paper", *Method], rows)]
        parts.append(f"Mean time per movement: {seconds(experiment['seconds'])}.\n")
    for table in results["tables"]:
        rows = [[cell if isinstance(cell, str) else with_note(*cell) for cell in cells] for _, *cells in table["rows"]]
        parts += [f"## {table['title']}", markdown(table["head"], rows)]
    return "\n".join(parts)


def markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return "".join(f"| {' | '.join(cells)} |\n" for cells in [head, ["---"] * len(head), *rows])


def texts(row: Mapping[str, Any]) -> list[str]:
    """The values of a row's methods, empty where there is none."""
    return [row["values"][method]["text"] if method in row["values"] else "" for method in Method]


def with_note(text: str, note: str) -> str:
    return f"{text}<br>*{note}*" if note else text


def seconds(methods: Mapping[str, Mapping[str, Mapping[str, float]]]) -> str:
    """How long the parts of a trial took, in words."""
    return "; ".join(
        f"{method} " + ", ".join(f"{part} {taken['mean']:.1f} s" for part, taken in parts.items())
        for method, parts in methods.items()
    )


def quick_results() -> dict[str, Any]:
    """The results of one movement, which static optimization makes twice with noise."""
    scenario = load_scenario("timing-0.4s")
    planned = plan(load_arm(scenario.arm), scenario.movement)
    task = scenario.task(planned.reference)
    loop = MakeStaticLoop(task)
    runs = [loop.Run(), *(loop.Run(np.random.default_rng(seed)) for seed in range(2))]
    outcome = Outcome(
        trial=Trial(scenario.name, Method.static),
        task=task,
        noise_free=runs[0],
        noisy=tuple(runs[1:]),
        perturbed=(),
        metrics=evaluation_metrics(task, runs[0], runs[1:], scenario.success),
        learning_curve=None,
        feasibility=muscle_feasibility(task.arm, task.reference),
        seconds={"plan": planned.seconds},
    )
    return collect_results(list(EXPERIMENTS.values()), [outcome], "python docs/make_results.py --quick")


if __name__ == "__main__":
    main()
