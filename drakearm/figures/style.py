"""What all pictures share: colors, axes, the raster of activations, and how they are saved."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from drakearm.files import replacement
from drakearm.systems.muscle_drawing import activation_color

# Okabe and Ito's colors, which color-blind readers can tell apart
COLORS = ("#0072B2", "#D55E00", "#009E73", "#56B4E9", "#E69F00", "#CC79A7")
NOTE_COLOR = "#555555"  # of text that explains
GOOD_COLOR, BAD_COLOR = "#00734F", "#CC0A1A"
ARM_COLOR, HAND_COLOR, OBSTACLE_COLOR = "#2B3440", "#F28C0D", "#CC5C3D"
NEAREST_COLOR = "#009480"  # of the arm where it is nearest to the obstacle
REST_COLOR = "#F1F3F6"  # of the time after the end of a movement
FONT = 10

# Decorates what draws a user's names: a $ in them is no formula, and they are no LaTeX code.
literal_text = rc_context({"text.parse_math": False, "text.usetex": False})


def joint_color(joint: int) -> str:
    """The color of a joint, by its place in the arm's coordinates."""
    return COLORS[joint % len(COLORS)]


def finish_panel(panel: Axes) -> None:
    """A pale grid behind the lines, and axes only at the left and the bottom."""
    panel.grid(color="#DDDDDD", linewidth=0.6)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)
    panel.tick_params(labelsize=FONT)


def finish_time_axis(panel: Axes, end: float, last: float) -> None:
    """From 0 s to the last time. What comes after the end of the movement, when the arm rests, is gray."""
    panel.axhline(0.0, color="black", linewidth=0.7, zorder=0.5)
    panel.axvspan(end, last, color=REST_COLOR, zorder=0)
    panel.set_xlim(0.0, last)
    finish_panel(panel)


def draw_raster(panel: Axes, t: np.ndarray, activation: np.ndarray, names: Sequence[str], top: float = 1.0) -> None:
    """Activations (N, n) at evenly spaced times t (N,), s: one row per muscle, and a bar that explains the colors.

    top: the activation of the strongest color.
    """
    colors = ListedColormap(activation_color(np.linspace(0.0, 1.0, 256)))
    half = 0.5 * (t[1] - t[0])
    extent = (t[0] - half, t[-1] + half, len(names) - 0.5, -0.5)
    cells = activation.T
    image = panel.imshow(cells, cmap=colors, aspect="auto", interpolation="nearest", extent=extent, vmin=0.0, vmax=top)
    panel.set_yticks(range(len(names)), names)
    panel.set_xlabel("time (s)", fontsize=FONT)
    panel.set_xlim(t[0], t[-1])
    panel.tick_params(labelsize=FONT - 1, length=2)
    bar = panel.figure.colorbar(image, ax=panel, pad=0.02, fraction=0.04)
    bar.ax.tick_params(labelsize=FONT - 1)


def save_picture(figure: Figure, file: Path, dpi: float) -> None:
    """Writes a .png, whole or not at all. Raises StorageError if the file system does not allow it."""
    with replacement(file) as partial:
        figure.savefig(partial, format="png", dpi=dpi)
