"""Many lines in one panel, each with its name at its end: no color is used twice, and no legend is needed."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from scipy.optimize import isotonic_regression

from drakearm.figures.style import DASHES, Look

_COLORMAP, _PALEST = colormaps["cividis"], 0.8  # for color-blind readers too; paler lines are hard to see on white
_LEADER: Look = {"arrowstyle": "-", "linewidth": 0.6, "shrinkA": 1, "shrinkB": 0, "relpos": (0.0, 0.5)}
_SPACING = 1.15  # of names, over the size of their letters


def many_lines(n: int) -> list[Look]:
    """The colors and dashes of n lines, from dark to pale. All colors differ."""
    shades = _PALEST * np.arange(n) / max(n - 1, 1)
    return [{"color": to_hex(_COLORMAP(x)), "linestyle": DASHES[i % len(DASHES)]} for i, x in enumerate(shades)]


def draw_labelled_lines(
    panel: Axes, x: np.ndarray, values: np.ndarray, names: Sequence[str], size: float = 8.0
) -> None:
    """Draws values (N, n) over x (N,), with n names to the right of the lines, whose letters have `size` points."""
    looks = many_lines(len(names))
    for samples, look in zip(values.T, looks, strict=True):
        panel.plot(x, samples, **look)
    panel.margins(x=0.0)
    low, high = panel.get_ylim()
    inches = panel.get_window_extent().transformed(panel.figure.dpi_scale_trans.inverted())
    places = spread((values[-1] - low) / (high - low), _SPACING * size / (72.0 * inches.height))
    for name, value, place, look in zip(names, values[-1], places, looks, strict=True):
        panel.annotate(
            name, (x[-1], value), xytext=(1.05, place), textcoords="axes fraction", va="center", fontsize=size,
            annotation_clip=False, parse_math=False,
            arrowprops={"color": look["color"]} | _LEADER,
        )  # fmt: skip


def spread(places: np.ndarray, distance: float) -> np.ndarray:
    """The places (n,) within 0 to 1 that are nearest to the given ones, and in their order at least a distance apart.

    If there is no room for this distance, they are as far apart as possible. Nearest in the sense of least squares:
    without the distances between neighbors, they are an isotonic regression.
    """
    n = len(places)
    distance = min(distance, 1.0 / max(n - 1, 1))
    order, steps = np.argsort(places, kind="stable"), distance * np.arange(n)
    free = isotonic_regression(places[order] - steps).x
    found = np.empty(n)
    found[order] = np.clip(free, 0.0, 1.0 - steps[-1]) + steps
    return found
