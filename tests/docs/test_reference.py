"""The reference: ports are drawn, docstrings become reST, and every public package has its page."""

import importlib
from pathlib import Path

import numpy as np
import pytest

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture
def extension(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    return importlib.import_module


def test_ports_are_drawn_as_a_box(extension):
    pytest.importorskip("docutils")
    picture = extension("pydrake_system").ports_svg("Sum", ["first", "<second>"], ["total"])
    for text in ("Sum", "first", "&lt;second&gt;", "total"):
        assert f">{text}</text>" in picture
    assert picture.count("<path") == 3 and picture.startswith("<svg") and picture.endswith("</svg>")


def test_tables_and_formulas_of_docstrings_become_rest(extension):
    convert = extension("markdown_docstrings").to_rest
    assert convert(["Power:", "", "    P = F v", ""]) == ["Power::", "", "    P = F v", ""]
    assert convert(["See:", "text"]) == ["See:", "text"]
    table = convert(["| a | b |", "|---|---|", "| 1 | 2 |"])
    assert [line.strip() for line in table if "*" in line or "- " in line] == ["* - a", "- b", "* - 1", "- 2"]


def test_fields_have_their_comments_and_plain_types(extension):
    from drakearm.model import Muscle

    fields = extension("class_docs").declared_fields(Muscle)
    assert fields["pennation_angle"] == ("Number", "at the optimal fiber length")
    assert list(fields) == list(Muscle.__dataclass_fields__)


def test_every_public_package_has_a_page():
    pages = {page.stem for page in (DOCS / "api").glob("*.md")} - {"index"}
    index = (DOCS / "api" / "index.md").read_text().split()
    assert pages <= set(index)
    packages = {name for name in pages if importlib.import_module(f"drakearm.{name}").__all__}
    assert packages == pages


def test_constants_are_named_on_the_page_of_their_package():
    """The reference shows docstrings, and a constant has none."""
    for page in (DOCS / "api").glob("*.md"):
        if page.stem == "index":
            continue
        package = importlib.import_module(f"drakearm.{page.stem}")
        for name in package.__all__:
            value = getattr(package, name)
            if isinstance(value, int | float | tuple | dict | np.ndarray):
                assert f"`{name}`" in page.read_text(), name


def test_the_names_of_the_package_itself_are_listed():
    listed = (DOCS / "api" / "index.md").read_text()
    for name in importlib.import_module("drakearm").__all__:
        assert f"`{name}`" in listed or f"`drakearm.{name}`" in listed, name
