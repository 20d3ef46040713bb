"""A picture of a plan: what the joints do, where the hand goes and what the muscles must do."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from drakearm.figures.side_view import SideView, capsule_edge
from drakearm.figures.style import (
    ARM_COLOR,
    BAD_COLOR,
    FONT,
    GOOD_COLOR,
    HAND_COLOR,
    NEAREST_COLOR,
    NOTE_COLOR,
    OBSTACLE_COLOR,
    draw_raster,
    finish_panel,
    finish_time_axis,
    joint_color,
    literal_text,
    save_picture,
)
from drakearm.planning.plan_report import PlanReport

_NEAR = 0.15  # of the height of a panel: limits that are farther away than this are written but not drawn
_DPI = 100


@literal_text
def write_plan_picture(report: PlanReport, file: Path) -> None:
    """Draws the plan into a .png. Raises StorageError if it cannot be written, and leaves the earlier picture then."""
    save_picture(draw_plan(report), file, dpi=_DPI)


@literal_text
def draw_plan(report: PlanReport) -> Figure:
    """Angles, speeds and torques over time on the left; the arm from the side and its activations on the right."""
    figure = Figure(figsize=(13.5, 9.2), facecolor="white")
    left = figure.add_gridspec(3, 1, left=0.065, right=0.485, top=0.83, bottom=0.065, hspace=0.32)
    right = figure.add_gridspec(2, 1, left=0.58, right=0.975, top=0.83, bottom=0.065, hspace=0.3, height_ratios=(3, 2))
    rows = [figure.add_subplot(left[i]) for i in range(3)]
    _draw_angles(rows[0], report)
    _draw_speeds(rows[1], report)
    _draw_torques(rows[2], report)
    rows[0].legend(loc="best", fontsize=FONT - 1, framealpha=0.7, edgecolor="none")
    for panel in rows:
        finish_time_axis(panel, report.plan.t[-1], report.plan.reference.t[-1])
    rows[2].set_xlabel("time (s)", fontsize=FONT)
    _draw_arm(figure.add_subplot(right[0]), report)
    _draw_activations(figure.add_subplot(right[1]), report)
    _head(figure, report)
    return figure


def _draw_angles(panel: Axes, report: PlanReport) -> None:
    angles = np.rad2deg(report.plan.reference.q)
    _by_joint(panel, report, angles, np.rad2deg(report.plan.q))
    for j, target in enumerate(report.movement.target_deg):
        panel.plot(
            report.plan.t[-1], target, marker="D", markersize=7, fillstyle="none", color=joint_color(j), zorder=3
        )
    lowest, highest = (np.rad2deg(limit) for limit in report.angle_limits)
    _title(panel, "joint angles (°), ◇ target", _draw_limits(panel, report, angles, lowest, highest, "°"))


def _draw_speeds(panel: Axes, report: PlanReport) -> None:
    speeds = report.plan.reference.v
    _by_joint(panel, report, speeds, report.plan.v)
    limit = np.array(report.movement.speed_limit)
    _title(panel, "joint speeds (rad/s)", _draw_limits(panel, report, speeds, -limit, limit, " rad/s"))


def _draw_torques(panel: Axes, report: PlanReport) -> None:
    """The torques of the plan. Where the muscles can exert less, the difference is hatched."""
    feasibility, torques = report.feasibility, report.plan.reference.tau
    _by_joint(panel, report, torques, report.plan.tau)
    limit = np.array(report.movement.torque_limit)
    _title(panel, "joint torques (Nm)", _draw_limits(panel, report, torques, -limit, limit, " Nm"))
    lacks = []
    for j, name in enumerate(feasibility.coordinates):
        lack = np.where(np.abs(feasibility.reserve[:, j]) > feasibility.negligible, feasibility.reserve[:, j], 0.0)
        if lack.any():
            lacks.append(panel.fill_between(feasibility.t, torques[:, j] - lack, torques[:, j]))
            lacks[-1].set(facecolor=(joint_color(j), 0.28), edgecolor=BAD_COLOR, linewidth=0, hatch="////")
            lacks[-1].set_label(f"{name}: the muscles lack up to {np.abs(lack).max():.3g} Nm")
    if lacks:
        low, high = panel.get_ylim()
        panel.set_ylim(low, high + 0.1 * (1 + len(lacks)) * (high - low))  # room for the legend
        panel.legend(handles=lacks, loc="upper center", fontsize=FONT - 1, frameon=False)


def _by_joint(panel: Axes, report: PlanReport, samples: np.ndarray, knots: np.ndarray) -> None:
    """One line per joint through the samples (N, n_q) of the reference, with a dot at each knot (K, n_q)."""
    for j, name in enumerate(report.feasibility.coordinates):
        panel.plot(report.plan.reference.t, samples[:, j], color=joint_color(j), linewidth=2.0, label=name)
        panel.plot(report.plan.t, knots[:, j], ".", color=joint_color(j), markersize=5)


def _draw_limits(
    panel: Axes, report: PlanReport, samples: np.ndarray, lowest: np.ndarray, highest: np.ndarray, unit: str
) -> str:
    """Draws the limits (n_q,) that a joint comes close to, and returns all limits as text."""
    panel.margins(y=0.08)
    room = _NEAR * np.ptp(panel.get_ylim())
    near_lowest, near_highest = lowest >= samples.min(axis=0) - room, highest <= samples.max(axis=0) + room
    for bounds, near in ((lowest, near_lowest), (highest, near_highest)):
        for j in np.flatnonzero(near).tolist():
            dashes = (4.0 * j, (4, 4))  # so that the dashes of two joints alternate
            panel.axhline(bounds[j], color=joint_color(j), linewidth=1.2, linestyle=dashes, zorder=1)
    drawn = "- - " if near_lowest.any() or near_highest.any() else ""
    if np.ptp(highest) == 0.0 and np.all(lowest == -highest):
        return f"{drawn}limits ±{highest[0]:g}{unit}"
    each = zip(report.feasibility.coordinates, lowest, highest, strict=True)
    return f"{drawn}limits: " + ", ".join(f"{name} {low:g} to {high:g}{unit}" for name, low, high in each)


def _title(panel: Axes, title: str, limits: str) -> None:
    panel.set_title(title, loc="left", fontsize=FONT + 1, fontweight="bold")
    panel.set_title(limits, loc="right", fontsize=FONT - 0.5, color=NOTE_COLOR)


def _draw_arm(panel: Axes, report: PlanReport) -> None:
    """The arm as sticks at six times, the path of the hand, and the arm where it is closest to the obstacle."""
    reference, obstacle = report.plan.reference, report.obstacle
    view = SideView(report.arm, obstacle)
    end = int(np.searchsorted(reference.t, report.plan.t[-1] - 1e-9))
    for k in np.unique(np.linspace(0, end, 6).round().astype(int)):
        stick = view.stick(reference.q[k])
        shade = 0.25 + 0.6 * k / max(end, 1)
        panel.plot(*stick.T, "-", color=ARM_COLOR, alpha=shade, linewidth=2.5, solid_capstyle="round", zorder=2)
        panel.plot(*stick[:-1].T, "o", color=ARM_COLOR, alpha=shade, markersize=5, zorder=2)
    hand = np.array([view.stick(q)[-1] for q in reference.q])
    forward = 1 if hand[end, 0] >= hand[0, 0] else -1  # the times are written before and behind the path of the hand
    for k, side in ((0, -forward), (end, forward)):
        text, sideways = f"{reference.t[k]:.2f} s", "left" if side > 0 else "right"
        panel.annotate(text, hand[k], (7 * side, -4), textcoords="offset points", ha=sideways, fontsize=FONT - 1)
    panel.plot(*hand.T, color=HAND_COLOR, linewidth=2.5, zorder=4, label="path of the hand")
    title = "the arm from the side (m)"
    found = report.plan.verification
    if obstacle is not None and found.nearest_time is not None and found.clearance is not None:
        x, y = view.project(np.array(obstacle.position))
        panel.add_patch(Circle((x, y), obstacle.radius, color=OBSTACLE_COLOR, zorder=3))
        nearest = np.array([np.interp(found.nearest_time, reference.t, angles) for angles in reference.q.T])
        for a, b, radius in view.outline(nearest):
            panel.fill(*capsule_edge(a, b, radius).T, color=NEAREST_COLOR, alpha=0.35, linewidth=0, zorder=2.5)
        title += f", nearest at {found.nearest_time:.2f} s: {100 * found.clearance:.2g} cm"
    panel.set_title(title, loc="left", fontsize=FONT + 1, fontweight="bold")
    panel.margins(0.08)
    panel.set_aspect("equal", adjustable="datalim")
    panel.legend(loc="best", fontsize=FONT - 1, framealpha=0.7, edgecolor="none")
    finish_panel(panel)


def _draw_activations(panel: Axes, report: PlanReport) -> None:
    """The activations that static optimization finds. A red bar at the top marks the times when they are not enough."""
    feasibility = report.feasibility
    draw_raster(panel, feasibility.t, feasibility.activation, report.arm.muscle_names)
    lacking = np.abs(feasibility.reserve).max(axis=1) > feasibility.negligible
    title = "activations needed"
    if lacking.any():
        above = panel.get_xaxis_transform()
        panel.fill_between(feasibility.t, 1.01, 1.05, where=lacking, color=BAD_COLOR, transform=above, clip_on=False)
        title += ", red bar: not enough"
    panel.set_title(title, loc="left", fontsize=FONT + 1, fontweight="bold", pad=12)


def _head(figure: Figure, report: PlanReport) -> None:
    """What was planned, how it was found, and whether the muscles can do it."""
    plan, found, feasibility = report.plan, report.plan.verification, report.feasibility
    costs = ", ".join(f"{name} {value:.3g}" for name, value in plan.costs.items())
    load = f"Load {report.load_mass:g} kg. " if report.load_mass else ""
    facts = (
        f"{plan.solver}: {plan.status}, {plan.iterations} iterations, {plan.seconds:.2f} s. {load}"
        f"Dots are the {len(plan.t)} knots. Costs: {costs}.\n"
        f"Nearest to a limit: angle {np.rad2deg(found.angle_margin) + 0.0:.1f}°, speed {found.speed_margin:.3g} rad/s, "
        f"torque {found.torque_margin:.3g} Nm. "
        f"Equations of motion hold to {found.speed_defect:.1g} rad/s and {found.acceleration_defect:.1g} rad/s²."
    )
    figure.text(0.02, 0.985, report.name, fontsize=18, fontweight="bold", va="top")
    figure.text(0.02, 0.948, report.description, fontsize=FONT + 1, va="top")
    color = GOOD_COLOR if feasibility.feasible else BAD_COLOR
    figure.text(0.02, 0.926, feasibility.verdict, fontsize=FONT + 1, va="top", color=color, fontweight="bold")
    figure.text(0.02, 0.903, facts, fontsize=FONT, va="top", color=NOTE_COLOR, linespacing=1.35)
