"""The report: all that it shows is inside of it, and results.json has the same numbers."""

import json
from html.parser import HTMLParser

import pytest

from drakearm.reproduction.catalog import EXPERIMENTS
from drakearm.reproduction.page import Table, table_html
from drakearm.reproduction.report import write_report

SHOWN = ("timing", "obstacle")


class Links(HTMLParser):
    """The targets of links, and everything that a browser would fetch by itself."""

    def __init__(self):
        super().__init__()
        self.targets, self.fetched = [], []

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "xlink:href", "src", "srcset", "data", "poster", "action"):
                (self.targets if tag == "a" else self.fetched).append(value)


@pytest.fixture(scope="module")
def report(tmp_path_factory, make_outcome):
    folder = tmp_path_factory.mktemp("report")
    trials = [trial for name in SHOWN for trial in EXPERIMENTS[name].trials(seeds=1)]
    replays = {trials[0]: f"runs/{trials[0].scenario}/replay.html"}
    pushes = Table("Pushes & pulls", ("push", "error (rad)"), [("", ("2 Nm", "0.01"))])
    outcomes = [make_outcome(trial) for trial in trials]
    return write_report(folder, list(EXPERIMENTS.values()), outcomes, "drakearm reproduce <all>", replays, [pushes])


def test_the_page_fetches_nothing_and_its_links_lead_somewhere(report):
    links = Links()
    links.feed(report.read_text())
    assert all(target.startswith(("#", "data:")) for target in links.fetched)
    assert "@import" not in report.read_text() and "url(http" not in report.read_text()
    assert "runs/timing-0.4s/replay.html" in links.targets
    assert all(f'id="{target[1:]}"' in report.read_text() for target in links.targets if target.startswith("#"))
    beside = [target for target in links.targets if not target.startswith(("runs/", "#"))]
    assert beside and all((report.parent / target).is_file() for target in beside)


def test_the_page_has_every_figure_and_number(report):
    page = report.read_text()
    results = json.loads((report.parent / "results.json").read_text())
    assert list(results["experiments"]) == list(SHOWN)  # those with outcomes
    figures = sorted(file.stem for file in (report.parent / "figures").glob("*.svg"))
    assert figures == ["fig5-timing", "fig6-learning", "fig9-obstacle"]
    assert page.count("<svg") == len(figures) and all(f'<figure id="{stem}">' in page for stem in figures)
    for experiment in results["experiments"].values():
        for row in experiment["rows"]:
            assert row["values"]
            for value in row["values"].values():
                assert f"<td>{value['text']}</td>" in page


def test_texts_are_escaped(report):
    page = report.read_text()
    assert "drakearm reproduce &lt;all&gt;" in page and "Pushes &amp; pulls" in page and "<all>" not in page


def test_rows_of_a_group_have_one_heading():
    html = table_html(Table("", ("a", "b"), [("first", ("1", ("2", "note"))), ("first", ("3", "4")), ("", ("5", "6"))]))
    assert html.count("first") == 1 and "<small>note</small>" in html
