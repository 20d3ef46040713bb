"""Figures as files: the same bytes every time, and drawings that can share a page."""

import re
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from drakearm.reproduction.figure_files import inline_svg, save_figure


def draw() -> Figure:
    figure = Figure(figsize=(2, 2))
    panel = figure.add_subplot()
    panel.plot([0, 1], [1, 0], "-o", label="a $ b")
    panel.legend()
    return figure


@pytest.fixture
def drawing(tmp_path) -> str:
    return save_figure(draw(), tmp_path, "one")


def test_a_figure_is_saved_as_the_same_bytes_every_time(tmp_path: Path, drawing):
    save_figure(draw(), tmp_path, "two")
    for kind in ("svg", "pdf"):
        assert (tmp_path / f"one.{kind}").read_bytes() == (tmp_path / f"two.{kind}").read_bytes()
    assert (tmp_path / "one.svg").read_text() == drawing


def test_ids_of_drawings_on_one_page_differ_and_are_all_used(drawing):
    first, second = (inline_svg(drawing, stem, "title") for stem in ("one", "two"))
    ids = [set(re.findall(r'\bid="([^"]+)"', text)) for text in (first, second)]
    assert ids[0] and not ids[0] & ids[1]
    assert ids[0] == set(re.findall(r'(?:href="#|url\(#)([^")]+)', first))
    assert first.startswith('<svg role="img" aria-label="title"')
