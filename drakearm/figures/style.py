"""What all pictures share: colors, lines, sizes, words, axes, legends, and how they are saved.

No color means something alone: joints, methods and muscles also have dashes or markers of their own, and areas have
hatches. So pictures can be read in gray, and by people who see fewer colors.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drakearm.files import replacement

Look = dict[str, Any]  # keyword arguments of Matplotlib

# Okabe and Ito's colors, which color-blind readers can tell apart
COLORS = ("#0072B2", "#D55E00", "#009E73", "#56B4E9", "#E69F00", "#CC79A7")
PALE_COLOR = "#F0E442"  # the seventh, for areas only
DASHES: tuple[Any, ...] = (
    "-",
    (0, (7, 1.5)),
    (0, (7, 1.5, 1.5, 1.5)),
    (0, (3, 1.2)),
    (0, (4, 1.2, 1, 1.2, 1, 1.2)),
)
DOTS = (0, (1, 1.6))  # of what is not the result itself: references, limits, what others report
HATCHES = ("////", "\\\\\\\\", "....", "xxxx", "||||", "----", "oooo")

TEXT_COLOR, NOTE_COLOR, FAINT_COLOR = "#000000", "#555555", "#777777"  # faint: of lines
GOOD_COLOR, BAD_COLOR = "#00734F", "#CC0A1A"
ARM_COLOR, HAND_COLOR = "#2B3440", "#F28C0D"
NEAREST_COLOR = "#009480"  # of the arm where it is nearest to the obstacle
OBSTACLE_COLOR = "#CC5C3D"
REST_COLOR = "#F1F3F6"  # of the time after the end of a movement
SPREAD = 0.25  # opacity of bands

OBSTACLE: Look = {"facecolor": OBSTACLE_COLOR, "edgecolor": ARM_COLOR, "hatch": "////", "linewidth": 0.8}
NEAREST: Look = {"color": NEAREST_COLOR, "alpha": 0.35, "linewidth": 0}
REFERENCE: Look = {"color": TEXT_COLOR, "linestyle": DOTS, "linewidth": 1.4}
STATIC: Look = {"color": COLORS[2], "linestyle": (0, (1.2, 1.2)), "marker": "s"}  # static optimization
POLICY: Look = {"color": COLORS[0], "linestyle": "-", "marker": "o"}
METABOLIC: Look = {"color": "#7A1F5C", "linestyle": "-"}
WORK: Look = {"color": "#5B8F29", "linestyle": DASHES[1]}

FONT, SMALL, HEADING = 10, 9, 18
LINE = 2.0

TIME = "time (s)"
ANGLE = "angle (°)"
SPEED = "speed (m/s)"
LOAD = "load (kg)"
CLEARANCE = "clearance (cm)"
ACTIVATION = "activation (0 to 1)"
HAND_END_ERROR = "end error, hand (cm)"
HAND_PATH = "path of the hand"
HAND_SPEED = "speed of the hand"
OBSTACLE_NAME = "obstacle"
NEAREST_NAME = "nearest to the obstacle, at"
REFERENCE_NAME = "reference"
STATIC_NAME = "static optimization"
DEVIATION = "± 1 standard deviation"

# Decorates what draws a user's names: a $ in them is no formula, and they are no LaTeX code.
literal_text = rc_context({"text.parse_math": False, "text.usetex": False})


def joint_line(joint: int) -> Look:
    """The color and the dashes of a joint, by its place in the arm's coordinates."""
    return {"color": COLORS[joint % len(COLORS)], "linestyle": DASHES[joint % len(DASHES)]}


def without_marker(look: Look) -> Look:
    """The look of lines only."""
    return {key: value for key, value in look.items() if key != "marker"}


def without_line(look: Look) -> Look:
    """The look of markers only."""
    return {key: value for key, value in look.items() if key != "linestyle"} | {"linestyle": ""}


def finish_panel(panel: Axes, title: str = "", x: str = "", y: str = "", size: float = FONT) -> None:
    """The title of a panel, what its axes show with units, a pale grid, and axes only at the left and the bottom."""
    panel.grid(color="#DDDDDD", linewidth=0.6)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)
    panel.tick_params(labelsize=size)
    panel.set_title(title, loc="left", fontsize=size + 1, fontweight="bold")
    panel.set_xlabel(x, fontsize=size)
    panel.set_ylabel(y, fontsize=size)


def finish_times(panels: Sequence[Axes], end: float, last: float) -> None:
    """From 0 s to the last time in panels below each other. What comes after the end, when the arm rests, is gray."""
    for panel in panels:
        panel.axhline(0.0, color=TEXT_COLOR, linewidth=0.7, zorder=0.5)
        panel.axvspan(end, last, color=REST_COLOR, zorder=0)
        panel.set_xlim(0.0, last)
        panel.tick_params(labelbottom=panel is panels[-1])
    panels[-1].set_xlabel(TIME, fontsize=FONT)


def legend_above(
    where: Axes | Figure, handles: Sequence[Any], left: float, bottom: float, columns: int | None = None
) -> None:
    """A legend without a frame, whose lower left corner is at (left, bottom) of a panel or a figure."""
    where.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(left, bottom), ncols=columns or len(handles),
        fontsize=SMALL, frameon=False, borderpad=0.0, borderaxespad=0.0, handlelength=2.6, columnspacing=1.4,
    )  # fmt: skip


def save_picture(figure: Figure, file: Path, dpi: float) -> None:
    """Writes a .png, whole or not at all. Raises StorageError if the file system does not allow it."""
    with replacement(file) as partial:
        figure.savefig(partial, format="png", dpi=dpi)
