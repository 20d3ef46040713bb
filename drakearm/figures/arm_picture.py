"""A picture of an inspected arm: one row of small panels per muscle. Angles are in degrees, for people to read."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator, MultipleLocator

from drakearm.figures.style import finish_panel, joint_color, literal_text, save_picture
from drakearm.model.inspection import Crossing, Inspection, MuscleInspection
from drakearm.model.musculature import RESTING_ACTIVATION

_ACTIVE, _PASSIVE, _RESTING, _WORKING = "#000000", "#CC79A7", "#777777", "#F0E442"
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
    colors = {name: joint_color(i) for i, name in enumerate(inspection.ranges)}
    panels = []
    for i in range(n):
        bottom = height - _TOP - i * (_ROW + _ROW_GAP) - _ROW
        lefts = [_MARGIN + _LABEL + _GAP + j * (_PANEL + _GAP) for j in range(5)]
        panels.append(
            [figure.add_axes((left / width, bottom / height, _PANEL / width, _ROW / height)) for left in lefts]
        )
    for muscle, row in zip(inspection.muscles, panels, strict=True):
        _label(row[0], muscle)
        _draw_lengths(row[0], muscle, colors)
        _draw_moment_arms(row[1], muscle, colors)
        _draw_force_length(row[2], muscle)
        _draw_force_velocity(row[3], muscle)
        _draw_tendon(row[4], muscle)
    _share_axes(panels, inspection)
    _head(figure, panels, inspection, colors)
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


def _by_angle(panel: Axes, crossing: Crossing, values: np.ndarray, color: str) -> None:
    """A line over the joint angle. It is dotted where the path function is its tangent, outside the fitted range."""
    q = np.rad2deg(crossing.q)
    fitted = (crossing.q >= crossing.fitted.lower) & (crossing.q <= crossing.fitted.upper)
    panel.plot(q, values, color=color, linewidth=1.1, linestyle=(0, (1, 1.6)))
    panel.plot(q, np.where(fitted, values, np.nan), color=color, linewidth=2.0)


def _draw_lengths(panel: Axes, inspected: MuscleInspection, colors: dict[str, str]) -> None:
    for c in inspected.crossings:
        if len(inspected.crossings) > 1:
            q = np.rad2deg(c.q)
            panel.fill_between(
                q, 1e3 * c.shortest, 1e3 * c.longest, color=colors[c.coordinate], alpha=0.13, linewidth=0
            )
        _by_angle(panel, c, 1e3 * c.length, colors[c.coordinate])
    if inspected.working.slack:
        bottom = panel.get_ylim()[0]
        top = min(1e3 * inspected.working.shortest_path, panel.get_ylim()[1])
        panel.axhspan(bottom, top, facecolor="none", edgecolor=_RESTING, hatch="///", linewidth=0)
        panel.set_ylim(bottom, None)


def _draw_moment_arms(panel: Axes, inspected: MuscleInspection, colors: dict[str, str]) -> None:
    panel.axhline(0.0, color="black", linewidth=0.8)
    for c in inspected.crossings:
        _by_angle(panel, c, 1e3 * c.moment_arm, colors[c.coordinate])


def _draw_force_length(panel: Axes, inspected: MuscleInspection) -> None:
    curves, working = inspected.curves, inspected.working.fiber_length
    if working:
        panel.axvspan(working.lower, working.upper, color=_WORKING, alpha=0.45, linewidth=0)
    panel.plot(curves.fiber_length, curves.active, color=_ACTIVE, linewidth=1.8)
    panel.plot(curves.fiber_length, curves.passive, color=_PASSIVE, linewidth=2.0, linestyle="--")
    panel.set(xlim=(curves.fiber_length[0], curves.fiber_length[-1]), ylim=(0.0, 1.5))


def _draw_force_velocity(panel: Axes, inspected: MuscleInspection) -> None:
    curves = inspected.curves
    panel.axvline(0.0, color="black", linewidth=0.8)
    panel.plot(curves.velocity, curves.resting_force, color=_RESTING, linewidth=1.6, linestyle="-.")
    panel.plot(curves.velocity, curves.force, color=_ACTIVE, linewidth=1.8)


def _draw_tendon(panel: Axes, inspected: MuscleInspection) -> None:
    if inspected.muscle.rigid_tendon:
        panel.text(0.5, 0.5, "rigid tendon", transform=panel.transAxes, ha="center", va="center", fontsize=_FONT)
        return
    curves, working = inspected.curves, inspected.working.tendon_strain
    if working:
        panel.axvspan(100 * working.lower, 100 * working.upper, color=_WORKING, alpha=0.45, linewidth=0)
        if working.upper > curves.strain[-1]:
            text = f"to {100 * working.upper:.1f} % →"
            panel.text(0.97, 0.08, text, transform=panel.transAxes, ha="right", fontsize=_FONT - 1)
    panel.plot(100 * curves.strain, curves.tendon, color=_ACTIVE, linewidth=1.8)


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
        finish_panel(panel)
        panel.tick_params(labelsize=_FONT, length=3, labelbottom=i == last)
        if i == last:
            panel.set_xlabel(_X_LABELS[j], fontsize=_FONT + 1)


def _head(figure: Figure, panels: list[list[Axes]], inspection: Inspection, colors: dict[str, str]) -> None:
    """The titles of the columns, with legends, and what holds for the whole picture."""
    joints = [Line2D([], [], color=color, linewidth=2.0, label=name) for name, color in colors.items()]
    beyond = Line2D([], [], color="black", linewidth=1.1, linestyle=(0, (1, 1.6)), label="beyond the fitted path")
    others = Patch(color=_RESTING, alpha=0.3, linewidth=0, label="at all angles of the other joints")
    slack = Patch(facecolor="none", edgecolor=_RESTING, hatch="///", linewidth=0, label="no equilibrium")
    working = Patch(color=_WORKING, alpha=0.45, linewidth=0, label="working range")
    full = Line2D([], [], color=_ACTIVE, linewidth=1.8, label="active, full activation")
    passive = Line2D([], [], color=_PASSIVE, linewidth=2.0, linestyle="--", label="passive")
    full_speed = Line2D([], [], color=_ACTIVE, linewidth=1.8, label="full activation")
    resting = Line2D([], [], color=_RESTING, linewidth=1.6, linestyle="-.", label=f"activation {RESTING_ACTIVATION:g}")
    some_slack = any(m.working.slack for m in inspection.muscles)
    several = any(len(m.crossings) > 1 for m in inspection.muscles)
    keys = (
        [*joints, *[others] * several, *[slack] * some_slack],
        [*joints, beyond],
        [full, passive, working],
        [full_speed, resting],
        [working],
    )
    for panel, title, handles in zip(panels[0], _TITLES, keys, strict=True):
        top = 1.0 + _TITLE / _ROW
        panel.text(
            0.5, top, title, transform=panel.transAxes, ha="center", va="top", fontsize=_FONT + 1, fontweight="bold"
        )
        panel.legend(
            handles=handles,
            loc="upper center",
            bbox_to_anchor=(0.5, top - 0.38 / _ROW),
            fontsize=_FONT - 0.5,
            frameon=False,
            borderpad=0.1,
            labelspacing=0.25,
            handlelength=2.2,
        )
    width, height = figure.get_size_inches()
    ranges = ", ".join(
        f"{name} {np.rad2deg(r.lower):.0f}° to {np.rad2deg(r.upper):.0f}°" for name, r in inspection.ranges.items()
    )
    neutral = ", ".join(f"{name} {np.rad2deg(angle):.0f}°" for name, angle in inspection.neutral.items())
    figure.text(_MARGIN / width, 1 - 0.18 / height, inspection.arm.name, fontsize=18, fontweight="bold", va="top")
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
