"""What the figures of all experiments share: how a method is drawn, and how panels are labelled."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from drakearm.figures.style import (
    COLORS,
    DASHES,
    DOTS,
    FAINT_COLOR,
    POLICY,
    REFERENCE_NAME,
    SMALL,
    SPREAD,
    STATIC,
    TEXT_COLOR,
    Look,
    finish_panel,
    without_line,
    without_marker,
)
from drakearm.reproduction.trial import Method

FONT = SMALL
REFERENCE: Look = {"color": TEXT_COLOR, "linewidth": 1.2, "linestyle": "-"}
PAPER: Look = {"color": "#444444", "linestyle": DOTS, "linewidth": 1.3}  # lines of what the paper reports
BAND: Look = {"color": FAINT_COLOR, "alpha": SPREAD, "linewidth": 0}  # in legends

# Apart from their colors, the methods have lines and markers of their own, for readers who see gray only.
_LOOKS: dict[Method, Look] = {
    Method.static: STATIC,
    Method.ppo_alone: {"color": COLORS[1], "linestyle": DASHES[1], "marker": "^"},
    Method.default: POLICY,
}


def method_line(method: Method) -> Look:
    """The color and the style of a method's lines, as arguments of `plot`."""
    return without_marker(_LOOKS[method])


def method_marker(method: Method) -> Look:
    """The color and the shape of a method's markers, as arguments of `plot`."""
    return without_line(_LOOKS[method])


def label_panel(panel: Axes, title: str = "", x: str = "", y: str = "") -> None:
    """Finishes a panel: its title, what its axes show with units, and the grid."""
    finish_panel(panel, title, x, y, size=FONT)


def legend_below(figure: Figure, handles: Sequence[Any], columns: int) -> None:
    """A legend at the bottom of the figure, where it covers nothing."""
    figure.legend(handles=handles, loc="lower center", ncols=columns, fontsize=FONT, frameon=False, handlelength=2.6)


def method_keys(methods: Sequence[Method]) -> list[Line2D]:
    """The entries of a legend for the lines of some methods."""
    return [Line2D([], [], linewidth=1.8, label=str(method), **method_line(method)) for method in methods]


def draw_band(panel: Axes, x: np.ndarray, runs: np.ndarray, **look: Any) -> None:
    """The mean of some runs (n, N) over x (N,), and their standard deviation as a band."""
    mean, deviation = runs.mean(axis=0), runs.std(axis=0)
    panel.fill_between(x, mean - deviation, mean + deviation, **BAND | {"color": look["color"]})
    panel.plot(x, mean, linewidth=1.8, **look)


def reference_key() -> Line2D:
    """The entry of a legend for the line of the reference."""
    return Line2D([], [], label=REFERENCE_NAME, **REFERENCE)
