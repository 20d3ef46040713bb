"""The colors and axes that all pictures share, and how they are saved."""

from pathlib import Path

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drakearm.files import replacement

# Okabe and Ito's colors, which color-blind readers can tell apart
COLORS = ("#0072B2", "#D55E00", "#009E73", "#56B4E9", "#E69F00", "#CC79A7")
NOTE_COLOR = "#555555"  # of text that explains

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


def save_picture(figure: Figure, file: Path, dpi: float) -> None:
    """Writes a .png, whole or not at all. Raises StorageError if the file system does not allow it."""
    with replacement(file) as partial:
        figure.savefig(partial, format="png", dpi=dpi)
