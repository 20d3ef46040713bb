"""A picture of an inspected arm: one row of small panels per muscle. Angles are in degrees, for people to read."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from drakearm.figures.style import (
    COLORS,
    DASHES,
    DOTS,
    FAINT_COLOR,
    HEADING,
    LINE,
    NOTE_COLOR,
    PALE_COLOR,
    TEXT_COLOR,
    Look,
    finish_panel,
    joint_line,
    literal_text,
    save_picture,
)
from drakearm.model.inspection import Crossing, Inspection, MuscleInspection
from drakearm.model.musculature import RESTING_ACTIVATION

_ACTIVE: Look = {"color": TEXT_COLOR, "linewidth": 1.8}
_PASSIVE: Look = {"color": COLORS[5], "linewidth": LINE, "linestyle": "--", "label": "passive"}
_RESTING: Look = {
    "color": FAINT_COLOR, "linewidth": 1.6, "linestyle": DASHES[2], "label": f"activation {RESTING_ACTIVATION:g}"
}  # fmt: skip
_WORKING: Look = {"color": PALE_COLOR, "alpha": 0.45, "linewidth": 0, "label": "working range"}
_SLACK: Look = {
    "facecolor": "none", "edgecolor": FAINT_COLOR, "hatch": "///", "linewidth": 0, "label": "no equilibrium"
}  # fmt: skip
_BEYOND, _OTHERS = _OF_ANY_JOINT = "beyond the fitted path", "at all angles of the other joints"
_TITLES = (
    "musculotendon length\n(mm)",
    "moment arm\n(mm, positive raises the angle)",
    "force-length\n(over max. isometric force)",
    "force-velocity\n(over isometric force)",
    "tendon force-strain\n(over max. isometric force)",
)
_X_LABELS = (
    "joint angle (°)",
    "joint angle (°)",
    "fiber length (optimal lengths)",
    "fiber velocity (optimal lengths / s)",
    "tendon strain (%)",
)
_LABEL, _PANEL, _GAP, _ROW, _ROW_GAP = 1.75, 2.45, 0.52, 0.98, 0.2  # inches
_TOP, _TITLE, _BOTTOM, _MARGIN = 2.15, 1.2, 0.65, 0.2
_FONT = 9.5
_VISIBLE = 0.1  # °: where joint limits are rounded, they may be beyond the fitted range by less


@literal_text
def write_arm_picture(inspection: Inspection, file: Path) -> None:
    """Draws the arm into a .png, and makes the file's folder if there is none.

    Raises StorageError if the file cannot be written. What was there before is then left as it was.
    """
    save_picture(draw_arm(inspection), file, dpi=110)


@literal_text
def draw_arm(inspection: Inspection) -> Figure:
    """Lengths, moment arms and curves of every muscle."""
    n = len(inspection.muscles)
    width = _MARGIN + _LABEL + 5 * (_PANEL + _GAP) + _MARGIN
    height = _TOP + n * (_ROW + _ROW_GAP) + _BOTTOM
    figure = Figure(figsize=(width, height), facecolor="white")
    looks = {name: joint_line(i) for i, name in enumerate(inspection.ranges)}
    panels = []
    for i in range(n):
        bottom = height - _TOP - i * (_ROW + _ROW_GAP) - _ROW
        lefts = [_MARGIN + _LABEL + _GAP + j * (_PANEL + _GAP) for j in range(5)]
        panels.append(
            [figure.add_axes((left / width, bottom / height, _PANEL / width, _ROW / height)) for left in lefts]
        )
    for muscle, row in zip(inspection.muscles, panels, strict=True):
        _label(row[0], muscle)
        _draw_lengths(row[0], muscle, looks)
        _draw_moment_arms(row[1], muscle, looks)
        _draw_force_length(row[2], muscle)
        _draw_force_velocity(row[3], muscle)
        _draw_tendon(row[4], muscle)
    _share_axes(panels, inspection)
    _head(figure, panels, inspection)
    return figure


def _label(panel: Axes, inspected: MuscleInspection) -> None:
    m, working = inspected.muscle, inspected.working.fiber_length
    works = f"works at {working.lower:.2f} to {working.upper:.2f}" if working else "slack everywhere"
    lines = (
        f"{m.max_isometric_force:.4g} N, {1e3 * m.mass:.0f} g",
        f"fiber {1e3 * m.optimal_fiber_length:.4g} mm, {np.rad2deg(m.pennation_angle):.0f}°",
        f"tendon {1e3 * m.tendon_slack_length:.4g} mm",
        works,
    )
    inches = (_LABEL + _GAP) / _PANEL
    panel.text(-inches, 1.0, m.name, transform=panel.transAxes, va="top", fontsize=13, fontweight="bold")
    panel.text(-inches, 0.74, "\n".join(lines), transform=panel.transAxes, va="top", fontsize=_FONT, linespacing=1.25)


def _by_angle(panel: Axes, crossing: Crossing, values: np.ndarray, look: Look) -> None:
    """A line over the joint angle. It is dotted where the path function is its tangent, outside the fitted range."""
    q = np.rad2deg(crossing.q)
    lower, upper = np.rad2deg([crossing.fitted.lower, crossing.fitted.upper])
    fitted = (q > lower - _VISIBLE) & (q < upper + _VISIBLE)
    panel.plot(q, np.where(fitted, values, np.nan), linewidth=LINE, label=crossing.coordinate, **look)
    if not fitted.all():
        beyond = np.where(fitted, np.nan, values)
        panel.plot(q, beyond, color=look["color"], linewidth=1.1, linestyle=DOTS, label=_BEYOND)


def _draw_lengths(panel: Axes, inspected: MuscleInspection, looks: dict[str, Look]) -> None:
    for c in inspected.crossings:
        if len(inspected.crossings) > 1:
            q, color = np.rad2deg(c.q), looks[c.coordinate]["color"]
            panel.fill_between(
                q, 1e3 * c.shortest, 1e3 * c.longest, color=color, alpha=0.13, linewidth=0, label=_OTHERS
            )
        _by_angle(panel, c, 1e3 * c.length, looks[c.coordinate])
    if inspected.working.slack:
        bottom = panel.get_ylim()[0]
        top = min(1e3 * inspected.working.shortest_path, panel.get_ylim()[1])
        panel.axhspan(bottom, top, **_SLACK)
        panel.set_ylim(bottom, None)


def _draw_moment_arms(panel: Axes, inspected: MuscleInspection, looks: dict[str, Look]) -> None:
    panel.axhline(0.0, color=TEXT_COLOR, linewidth=0.8)
    for c in inspected.crossings:
        _by_angle(panel, c, 1e3 * c.moment_arm, looks[c.coordinate])


def _draw_force_length(panel: Axes, inspected: MuscleInspection) -> None:
    curves, working = inspected.curves, inspected.working.fiber_length
    panel.plot(curves.fiber_length, curves.active, label="active, full activation", **_ACTIVE)
    panel.plot(curves.fiber_length, curves.passive, **_PASSIVE)
    if working:
        panel.axvspan(working.lower, working.upper, zorder=1, **_WORKING)
    panel.set(xlim=(curves.fiber_length[0], curves.fiber_length[-1]), ylim=(0.0, 1.5))


def _draw_force_velocity(panel: Axes, inspected: MuscleInspection) -> None:
    curves = inspected.curves
    panel.axvline(0.0, color=TEXT_COLOR, linewidth=0.8)
    panel.plot(curves.velocity, curves.force, label="full activation", **_ACTIVE)
    panel.plot(curves.velocity, curves.resting_force, zorder=1.9, **_RESTING)


def _draw_tendon(panel: Axes, inspected: MuscleInspection) -> None:
    if inspected.muscle.rigid_tendon:
        panel.text(0.5, 0.5, "rigid tendon", transform=panel.transAxes, ha="center", va="center", fontsize=_FONT)
        return
    curves, working = inspected.curves, inspected.working.tendon_strain
    if working:
        panel.axvspan(100 * working.lower, 100 * working.upper, **_WORKING)
        if working.upper > curves.strain[-1]:
            text = f"to {100 * working.upper:.1f} % →"
            panel.text(0.97, 0.08, text, transform=panel.transAxes, ha="right", fontsize=_FONT - 1)
    panel.plot(100 * curves.strain, curves.tendon, **_ACTIVE)


def _share_axes(panels: list[list[Axes]], inspection: Inspection) -> None:
    """Gives all panels of a column the same limits and ticks, and labels the horizontal axes in the last row only."""
    lower = np.rad2deg(min(r.lower for r in inspection.ranges.values()))
    upper = np.rad2deg(max(r.upper for r in inspection.ranges.values()))
    fastest = max(m.curves.velocity[-1] for m in inspection.muscles)
    strain = 100 * max(m.curves.strain[-1] for m in inspection.muscles)
    last = len(panels) - 1
    for i, j in np.ndindex(len(panels), 5):
        panel = panels[i][j]
        if j < 2:
            panel.set_xlim(lower - 3.0, upper + 3.0)
            panel.xaxis.set_major_locator(MultipleLocator(45))
            panel.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
            panel.margins(y=0.1)
        elif j == 3:
            panel.set(xlim=(-fastest, fastest), ylim=(0.0, 2.0))
        elif j == 4:
            panel.set(xlim=(0.0, strain), ylim=(0.0, 1.5))
            panel.xaxis.set_major_locator(MultipleLocator(1))
        if j >= 2:
            panel.yaxis.set_major_locator(MultipleLocator(0.5))
        finish_panel(panel, x=_X_LABELS[j] if i == last else "", size=_FONT)
        panel.tick_params(length=3, labelbottom=i == last)


def _head(figure: Figure, panels: list[list[Axes]], inspection: Inspection) -> None:
    """The titles of the columns, with legends, and what holds for the whole picture."""
    for column, title in zip(zip(*panels, strict=True), _TITLES, strict=True):
        top = 1.0 + _TITLE / _ROW
        column[0].text(
            0.5, top, title, transform=column[0].transAxes, ha="center", va="top", fontsize=_FONT + 1, fontweight="bold"
        )
        _legend(column, top - 0.38 / _ROW)
    width, height = figure.get_size_inches()
    ranges = ", ".join(
        f"{name} {np.rad2deg(r.lower):z.0f}° to {np.rad2deg(r.upper):z.0f}°" for name, r in inspection.ranges.items()
    )
    neutral = ", ".join(f"{name} {np.rad2deg(angle):z.0f}°" for name, angle in inspection.neutral.items())
    figure.text(_MARGIN / width, 1 - 0.18 / height, inspection.arm.name, fontsize=HEADING, fontweight="bold", va="top")
    figure.text(
        (_MARGIN + _LABEL + _GAP) / width,
        1 - 0.16 / height,
        f"Joint ranges: {ranges}. While one joint moves, the others stay at {neutral}.\n"
        "Working range: fiber lengths (in optimal lengths) and tendon strains in equilibrium over all joint angles, "
        f"at activation {RESTING_ACTIVATION:g}. Mass is that of the fibers.",
        fontsize=_FONT + 0.5,
        va="top",
        linespacing=1.4,
    )


def _legend(column: Sequence[Axes], top: float) -> None:
    """Explains what the panels of a column show, in a legend above the first: each label that they have, once."""
    shown: dict[str, Artist] = {}
    for panel in column:
        for artist, label in zip(*panel.get_legend_handles_labels(), strict=True):
            shown.setdefault(label, artist)
    if not shown:
        return
    labels = sorted(shown, key=lambda label: label in _OF_ANY_JOINT)  # the joints first
    legend = column[0].legend(
        [shown[label] for label in labels], labels, loc="upper center", bbox_to_anchor=(0.5, top),
        fontsize=_FONT - 0.5, frameon=False, borderpad=0.1, labelspacing=0.25, handlelength=2.6,
    )  # fmt: skip
    for handle, label in zip(legend.legend_handles, labels, strict=True):
        if handle and label in _OF_ANY_JOINT:
            handle.set(color=NOTE_COLOR, alpha=shown[label].get_alpha())
