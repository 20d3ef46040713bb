"""What the figures of all experiments share: how a method is drawn, and how panels are labelled."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from drakearm.figures.style import COLORS, finish_panel
from drakearm.reproduction.trial import Method

Look = dict[str, Any]  # keyword arguments of Matplotlib
FONT = 9
REFERENCE_COLOR = "#000000"
PAPER: Look = {"color": "#444444", "linestyle": (0, (1, 1.5)), "linewidth": 1.3}  # lines of what the paper reports

# Apart from their colors, the methods have lines and markers of their own, for readers who see gray only.
_LOOKS: dict[Method, Look] = {
    Method.static: {"color": COLORS[2], "linestyle": (0, (1.2, 1.2)), "marker": "s"},
    Method.ppo_alone: {"color": COLORS[1], "linestyle": (0, (5, 1.5)), "marker": "^"},
    Method.default: {"color": COLORS[0], "linestyle": "-", "marker": "o"},
}


def method_line(method: Method) -> Look:
    """The color and the style of a method's lines, as arguments of `plot`."""
    return {key: value for key, value in _LOOKS[method].items() if key != "marker"}


def method_marker(method: Method) -> Look:
    """The color and the shape of a method's markers, as arguments of `plot`."""
    return {key: value for key, value in _LOOKS[method].items() if key != "linestyle"}


def label_panel(panel: Axes, title: str = "", x: str = "", y: str = "") -> None:
    """Finishes a panel: its title, what its axes show with units, and the grid."""
    finish_panel(panel)
    panel.set_title(title, loc="left", fontsize=FONT + 1, fontweight="bold")
    panel.set_xlabel(x, fontsize=FONT)
    panel.set_ylabel(y, fontsize=FONT)
    panel.tick_params(labelsize=FONT)


def legend_below(figure: Figure, handles: Sequence[Any], columns: int) -> None:
    """A legend at the bottom of the figure, where it covers nothing."""
    figure.legend(handles=handles, loc="lower center", ncols=columns, fontsize=FONT, frameon=False, handlelength=2.6)


def method_keys(methods: Sequence[Method]) -> list[Line2D]:
    """The entries of a legend for the lines of some methods."""
    return [Line2D([], [], linewidth=1.8, label=str(method), **method_line(method)) for method in methods]


def draw_band(panel: Axes, x: np.ndarray, runs: np.ndarray, alpha: float = 0.2, **look: Any) -> None:
    """The mean of some runs (n, N) over x (N,), and their standard deviation as a band."""
    mean, deviation = runs.mean(axis=0), runs.std(axis=0)
    panel.fill_between(x, mean - deviation, mean + deviation, color=look["color"], alpha=alpha, linewidth=0)
    panel.plot(x, mean, linewidth=1.8, **look)
