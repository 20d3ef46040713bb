"""A raster of activations over time: one row per muscle, ordered by joint and role."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.image import AxesImage

from drakearm.figures.muscle_roles import Role
from drakearm.figures.style import ACTIVATION, NOTE_COLOR, SMALL, TIME
from drakearm.model import Arm

# From pale to dark in even steps of lightness, so it can be read in gray. They are steps of the root of the activation:
# 0.01, the activation at rest, differs from 0 and from 0.05. The colors of the 3D views are too alike there.
COLORMAP = colormaps["magma_r"]
TICKS = (0.0, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0)


def activation_norm() -> PowerNorm:
    """From an activation to its place in COLORMAP. It is the same for all pictures, so that they can be compared."""
    return PowerNorm(0.5, vmin=0.0, vmax=1.0)


def draw_raster(panel: Axes, t: np.ndarray, activation: np.ndarray, arm: Arm, roles: Sequence[Role]) -> AxesImage:
    """Activations (N, n) of an arm's muscles at evenly spaced times t (N,), s.

    roles: of these muscles, see `muscle_roles`, in the order of the rows; lines separate them.
    """
    rows = [i for role in roles for i in role.muscles]
    half = 0.5 * (t[1] - t[0])
    image = panel.imshow(
        activation[:, rows].T,
        cmap=COLORMAP,
        norm=activation_norm(),
        aspect="auto",
        interpolation="nearest",
        extent=(t[0] - half, t[-1] + half, len(rows) - 0.5, -0.5),
    )
    for end in np.cumsum([len(role.muscles) for role in roles])[:-1]:
        panel.axhline(end - 0.5, color=NOTE_COLOR, linewidth=1.0)
    panel.set_yticks(range(len(rows)), [arm.muscle_names[i] for i in rows])
    panel.set_xlabel(TIME, fontsize=SMALL)
    panel.set_xlim(t[0], t[-1])
    panel.tick_params(labelsize=SMALL, length=2)
    return image


def raster_places(place: SubplotSpec) -> tuple[SubplotSpec, SubplotSpec]:
    """Divides a place: for the raster, and for its bar. Room is left for the roles, and for the numbers of the bar."""
    grid = place.subgridspec(1, 4, width_ratios=(1.0, 0.42, 0.035, 0.13), wspace=0.0)
    return grid[0], grid[2]


def label_roles(panel: Axes, roles: Sequence[Role]) -> None:
    """Says to the right of a raster what the muscles between two lines do."""
    first = 0
    for role in roles:
        middle = first + 0.5 * len(role.muscles) - 0.5
        panel.annotate(
            role.label, (1.0, middle), xycoords=panel.get_yaxis_transform(), xytext=(5, 0),
            textcoords="offset points", va="center", fontsize=SMALL - 1, annotation_clip=False,
        )  # fmt: skip
        first += len(role.muscles)


def activation_bar(figure: Figure, image: AxesImage, place: tuple[float, float, float, float]) -> Axes:
    """The bar that explains the colors of a raster, at a place (left, bottom, width, height) of the figure."""
    bar = figure.colorbar(image, cax=figure.add_axes(place), ticks=TICKS, format="{x:g}")
    bar.minorticks_off()
    bar.set_label(ACTIVATION, fontsize=SMALL)
    bar.ax.tick_params(labelsize=SMALL)
    return bar.ax
