"""No link is dead: in the Markdown pages, as GitHub shows them, and in a built site."""

import re
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from markdown_it import MarkdownIt

from docs.check_links import dead_links

ROOT = Path(__file__).parents[2]
PAGES = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("drakearm/**/*.md")]
PAGES = [page for page in PAGES if "_build" not in page.parts]


def tokens(page: Path):
    for token in MarkdownIt().enable("table").parse(page.read_text(encoding="utf-8")):
        yield token
        yield from token.children or []


def places(page: Path) -> set[str]:
    """The names that GitHub gives to headings."""
    found, previous = set(), None
    for token in tokens(page):
        if previous == "heading_open":
            text = re.sub(r"[^\w\- ]", "", token.content.lower())
            found.add(text.replace(" ", "-"))
        previous = token.type
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_a_file_and_a_heading(page):
    for token in tokens(page):
        target = token.attrGet("href") or token.attrGet("src")
        if target is None or urlsplit(target).scheme:
            continue
        path, place = unquote(urlsplit(target).path), urlsplit(target).fragment
        file = (page.parent / path).resolve() if path else page
        assert file.exists(), target
        assert not place or place in places(file), target


def test_pages_have_links():
    assert len(PAGES) > 30
    assert sum(token.attrGet("href") is not None for page in PAGES for token in tokens(page)) > 50


def test_dead_links_of_a_site_are_found(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.html").write_text('<a href="sub/b.html#here"></a><a href="https://else.where"></a><p id="top">')
    (tmp_path / "sub" / "b.html").write_text('<a href="../a.html#top"></a><h1 id="here"></h1><img src="../c.png">')
    assert dead_links(tmp_path) == ["sub/b.html: ../c.png"]
    (tmp_path / "c.png").touch()
    assert dead_links(tmp_path) == []
    (tmp_path / "a.html").write_text('<a href="#nowhere"></a><a href="d.html"></a>')
    assert dead_links(tmp_path) == ["a.html: #nowhere", "a.html: d.html", "sub/b.html: ../a.html#top"]
