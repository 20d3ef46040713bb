"""The web page of two replays side by side, with one clock and one set of controls.

Each half is the page of a replay, in a frame. Meshcat's library, which is nearly all of such a page, is there once.
"""

import html
import re
from string import Template

from drakearm.model import Arm
from drakearm.replay.page import POLICY, as_json, make_controls, part

_LIBRARY = re.compile(r"<body[^>]*>.*?<script[^>]*>(.*?)</script>", re.DOTALL)  # the first script of Meshcat's page


def make_comparison(halves: tuple[str, str], titles: tuple[str, str], arms: tuple[Arm, Arm], seconds: float) -> str:
    """A page from two pages of `make_page`, which have no controls. seconds: of the longer movement."""
    pages, libraries = zip(*map(_without_library, halves), strict=True)
    assert libraries[0] == libraries[1]
    return Template(part("comparison.html")).substitute(
        policy=POLICY,
        style=part("page.css"),
        title=html.escape(" and ".join(titles)),
        left=html.escape(titles[0]),
        right=html.escape(titles[1]),
        controls=make_controls(seconds, arms),
        library=libraries[0],
        pages=as_json(pages),
        script=part("comparison.js") + part("controls.js"),
    )


def _without_library(page: str) -> tuple[tuple[str, str], str]:
    """A page before and after the text of Meshcat's library, and this text."""
    found = _LIBRARY.search(page)
    assert found is not None
    return (page[: found.start(1)], page[found.end(1) :]), found[1]
