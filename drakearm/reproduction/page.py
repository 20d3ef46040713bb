"""The web page of a report: it holds all that it shows, and reads well on a phone, in the light and in the dark."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template
from typing import Any

from drakearm.files import replacement

Cell = str | tuple[str, str]  # a text, or a text and a note below it


@dataclass(frozen=True)
class Table:
    """A table of a report. rows: for each its group, which becomes a heading, and its cells."""

    title: str
    head: Sequence[str]
    rows: Sequence[tuple[str, Sequence[Cell]]]

    @property
    def content(self) -> dict[str, Any]:
        """The table as JSON."""
        return {"title": self.title, "head": list(self.head), "rows": [[g, *cells] for g, cells in self.rows]}


def table_html(table: Table) -> str:
    lines = ["".join(f"<th>{escape(name)}</th>" for name in table.head)]
    before = ""
    for group, cells in table.rows:
        if group != before:
            lines.append(f'<th colspan="{len(table.head)}" class="group">{escape(group)}</th>' if group else "")
            before = group
        lines.append("".join(f"<td>{_cell(cell)}</td>" for cell in cells))
    rows = "\n".join(f"<tr>{line}</tr>" for line in lines if line)
    return f'<div class="wide"><table>\n{rows}\n</table></div>'


def write_page(file: Path, results: Mapping[str, Any], sections: Sequence[str]) -> None:
    """Writes the report. Raises StorageError if the file cannot be written."""
    versions = ", ".join(f"{name} {number}" for name, number in results["versions"].items())
    titles = {name: experiment["title"] for name, experiment in results["experiments"].items()}
    text = _PAGE.substitute(
        command=escape(results["command"]),
        versions=escape(versions),
        contents=" · ".join(f'<a href="#{escape(name)}">{escape(title)}</a>' for name, title in titles.items()),
        sections="\n".join(sections),
    )
    with replacement(file) as partial:
        partial.write_text(text, encoding="utf-8")


def _cell(cell: Cell) -> str:
    text, note = cell if isinstance(cell, tuple) else (cell, "")
    return escape(text) + (f"<small>{escape(note)}</small>" if note else "")


# The policy lets the browser refuse every request: all that the page shows is inside of it.
_PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<title>The paper's experiments, reproduced with drakearm</title>
<style>
  :root { color-scheme: light dark; }
  :root { --text: #1d2329; --back: #ffffff; --pale: #f1f3f6; --line: #d5dae0; --note: #59636e; }
  @media (prefers-color-scheme: dark) {
    :root { --text: #e4e8ec; --back: #15191e; --pale: #222930; --line: #3a434d; --note: #9aa5b1; }
    a { color: #7db7f0; }
  }
  body { font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--back); }
  body { max-width: 1080px; margin: 0 auto; padding: 16px; }
  h1 { font-size: 1.6em; line-height: 1.2; }
  h2 { margin-top: 2em; border-top: 1px solid var(--line); padding-top: 1em; }
  p { max-width: 46em; } code { background: var(--pale); padding: 2px 5px; border-radius: 4px; }
  .wide { overflow-x: auto; }
  table { border-collapse: collapse; font-size: 0.88em; font-variant-numeric: tabular-nums; }
  th, td { text-align: left; vertical-align: top; padding: 5px 14px 5px 6px; border-bottom: 1px solid var(--line); }
  td:first-child { min-width: 11em; max-width: 24em; position: sticky; left: 0; background: var(--back); }
  td:not(:first-child) { white-space: nowrap; }
  th.group { padding-top: 16px; background: var(--pale); }
  small { display: block; color: var(--note); }
  figure { margin: 28px 0; } figcaption { color: var(--note); font-size: 0.88em; }
  figure svg { display: block; width: 100%; min-width: 680px; height: auto; background: #ffffff; border-radius: 6px; }
  details { margin: 16px 0; } li { margin: 3px 0; }
</style>
</head>
<body>
<h1>The paper's experiments, reproduced with drakearm</h1>
<p>Optimal control plans how the two joints of an arm move. Then three methods find the excitations of its 14 muscles:
<b>static optimization</b> (computed muscle control) without learning; <b>PPO alone</b>, as in the paper: 28
observations, random weights, no teacher; and drakearm's <b>default</b> way to learn. All runs are simulations of the
arm's Drake Diagram. The paper is Denizdurduran, Markram and Gewaltig, <i>Optimum trajectory
learning in musculoskeletal systems with model predictive control and deep reinforcement learning</i>, Biological
Cybernetics 116, 2022.</p>
<p>Made by <code>$command</code> with $versions. A value is the mean ± the standard deviation over all runs with
noise; with several seeds, the standard deviation between the seeds' means follows. The same numbers are in
<a href="results.json">results.json</a>.</p>
<p>$contents</p>
$sections
<section>
<h2>Credits</h2>
<p>The arm is adapted from the authors' OpenSim model (CC BY 3.0; Holzbaur, Murray and Delp 2005, OpenSim Development
Team). The speed profiles of people are derived from HuG-MP (Copyright (c) 2025 TUM Chair of Information-oriented
Control, MIT License; Bianchin et al., <i>Human-Centered Geodesics for Motion Planning</i>, ICORR 2025). Seven people
moved their hand in an exoskeleton in transparent mode, at their own slow pace, mostly by 45 cm, with gravity. These are
not the people of Shadmehr et al. (2005), with whom the paper compares: those recordings are not public.</p>
</section>
</body>
</html>
""")
