"""The report of a reproduction: report.html, results.json and the figures, in one folder."""

import json
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from drakearm.files import replacement
from drakearm.reproduction.experiment import Experiment
from drakearm.reproduction.figure_files import inline_svg, save_figure
from drakearm.reproduction.page import Table, table_html, write_page
from drakearm.reproduction.results import collect_results, outcomes_of
from drakearm.reproduction.trial import Method, Outcome, Trial

FIGURES = "figures"  # the folder of the figures, beside the report


def write_report(
    folder: Path,
    experiments: Sequence[Experiment],
    outcomes: Sequence[Outcome],
    command: str,
    replays: Mapping[Trial, str] | None = None,
    tables: Sequence[Table] = (),
) -> Path:
    """Writes report.html, results.json, and each figure as SVG and PDF. Returns the report's file.

    command: that made the outcomes. replays: paths of the replays of some trials, relative to the folder. tables:
    further ones, at the end of the report. Raises StorageError if a file cannot be written.
    """
    results = collect_results(experiments, outcomes, command, tables)
    with replacement(folder / "results.json") as partial:
        partial.write_text(json.dumps(results, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    sections = []
    for experiment in experiments:
        if experiment.name in results["experiments"]:
            some = outcomes_of(experiment, outcomes)
            figures = _figures(experiment, some, folder / FIGURES)
            sections.append(
                _section(experiment.name, results["experiments"][experiment.name], some, figures, replays or {})
            )
    sections += [f"<section><h2>{escape(table.title)}</h2>{table_html(table)}</section>" for table in tables]
    write_page(folder / "report.html", results, sections)
    return folder / "report.html"


def _figures(experiment: Experiment, outcomes: Sequence[Outcome], folder: Path) -> list[str]:
    """Saves the figures of an experiment and returns their HTML."""
    found = []
    for stem, figure in experiment.figures(outcomes).items():
        drawing = inline_svg(save_figure(figure, folder, stem), stem, escape(f"{experiment.title}: {stem}"))
        links = ", ".join(f'<a href="{FIGURES}/{stem}.{kind}">{kind.upper()}</a>' for kind in ("svg", "pdf"))
        caption = f"<figcaption>{escape(stem)} ({links})</figcaption>"
        found.append(f'<figure id="{stem}"><div class="wide">{drawing}</div>{caption}</figure>')
    return found


def _section(
    name: str,
    experiment: Mapping[str, Any],
    outcomes: Sequence[Outcome],
    figures: Sequence[str],
    replays: Mapping[Trial, str],
) -> str:
    return "\n".join(
        [
            f'<section id="{escape(name)}">',
            f"<h2>{escape(experiment['title'])}</h2>",
            f"<p>{escape(experiment['text'])}</p>",
            table_html(_results_table(experiment)),
            *figures,
            "<h3>How long it took</h3>",
            table_html(_seconds_table(experiment)),
            _replay_links([outcome.trial for outcome in outcomes], replays),
            "</section>",
        ]
    )


def _results_table(experiment: Mapping[str, Any]) -> Table:
    rows = [
        (row["group"], [(row["quantity"], row["note"]), row["paper"], *(_text(row, method) for method in Method)])
        for row in experiment["rows"]
    ]
    return Table(experiment["title"], ("quantity", "paper", *map(str, Method)), rows)


def _text(row: Mapping[str, Any], method: Method) -> str:
    return row["values"][method]["text"] if method in row["values"] else ""


def _seconds_table(experiment: Mapping[str, Any]) -> Table:
    rows: list[tuple[str, list[Any]]] = [
        ("", [method, *(f"{part['mean']:.1f} (at most {part['largest']:.1f})" for part in parts.values())])
        for method, parts in experiment["seconds"].items()
    ]
    parts = next(iter(experiment["seconds"].values()))
    return Table("", ("seconds per movement", *parts), rows)


def _replay_links(trials: Sequence[Trial], replays: Mapping[Trial, str]) -> str:
    items = [
        f'<li><a href="{escape(replays[trial])}">{escape(trial.scenario)}, {trial.method}, seed {trial.seed}</a></li>'
        for trial in trials
        if trial in replays
    ]
    if not items:
        return ""
    return f"<details><summary>Replays of {len(items)} movements</summary><ul>{''.join(items)}</ul></details>"
