"""Figures as SVG and PDF. The same figure gives the same bytes every time: no dates, no random names."""

import io
import re
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

from drakearm.files import replacement

_SETTINGS: Any = {"svg.hashsalt": "drakearm", "svg.fonttype": "path", "text.parse_math": False, "text.usetex": False}


def svg(figure: Figure) -> str:
    """The figure as the text of an SVG file."""
    file = io.StringIO()
    with rc_context(_SETTINGS):
        figure.savefig(file, format="svg", metadata={"Date": None})
    return file.getvalue()


def save_figure(figure: Figure, folder: Path, stem: str) -> str:
    """Writes STEM.svg and STEM.pdf into a folder, and returns the text of the SVG. Raises StorageError if it cannot."""
    text = svg(figure)
    with replacement(folder / f"{stem}.svg") as partial:
        partial.write_text(text, encoding="utf-8")
    with replacement(folder / f"{stem}.pdf") as partial, rc_context(_SETTINGS):
        figure.savefig(partial, format="pdf", metadata={"CreationDate": None})
    return text


def inline_svg(text: str, stem: str, title: str) -> str:
    """An SVG for a web page that holds several: its ids begin with the stem.

    title: what screen readers say, already escaped.
    """
    text = text[text.index("<svg") :]
    used = set(re.findall(r'(?:href="#|url\(#)([^")]+)', text))
    text = re.sub(r' id="([^"]+)"', lambda found: f' id="{stem}-{found[1]}"' if found[1] in used else "", text)
    text = re.sub(r'(href="#|url\(#)', rf"\g<1>{stem}-", text)
    return text.replace("<svg", f'<svg role="img" aria-label="{title}"', 1)
