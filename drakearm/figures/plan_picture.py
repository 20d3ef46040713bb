"""A picture of a plan: what the joints do, where the hand goes and what the muscles must do."""

from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from drakearm.figures.muscle_roles import ROLES, muscle_roles
from drakearm.figures.raster import activation_bar, draw_raster, label_roles, raster_places
from drakearm.figures.side_view import SideView, capsule_edge
from drakearm.figures.style import (
    ANGLE,
    ARM_COLOR,
    BAD_COLOR,
    FONT,
    GOOD_COLOR,
    HAND_COLOR,
    HAND_PATH,
    HATCHES,
    HEADING,
    LINE,
    NEAREST,
    NEAREST_NAME,
    NOTE_COLOR,
    OBSTACLE,
    OBSTACLE_NAME,
    SMALL,
    TEXT_COLOR,
    finish_panel,
    finish_times,
    joint_line,
    legend_above,
    literal_text,
    save_picture,
)
from drakearm.planning.plan_report import PlanReport

_NEAR = 0.15  # of the height of a panel: limits that are farther away than this are written but not drawn
_DPI = 100
_LEFT, _RIGHT, _TOP, _LEGENDS = 0.065, 0.58, 0.795, 0.835  # of the figure


@literal_text
def write_plan_picture(report: PlanReport, file: Path) -> None:
    """Draws the plan into a .png. Raises StorageError if it cannot be written, and leaves the earlier picture then."""
    save_picture(draw_plan(report), file, dpi=_DPI)


@literal_text
def draw_plan(report: PlanReport) -> Figure:
    """Angles, speeds and torques over time on the left; the arm from the side and its activations on the right."""
    figure = Figure(figsize=(13.5, 9.6), facecolor="white")
    left = figure.add_gridspec(3, 1, left=_LEFT, right=0.485, top=_TOP, bottom=0.1, hspace=0.2)
    right = figure.add_gridspec(2, 1, left=_RIGHT, right=0.965, top=_TOP, bottom=0.1, hspace=0.36, height_ratios=(3, 2))
    rows = [figure.add_subplot(left[i]) for i in range(3)]
    _draw_angles(rows[0], report)
    _draw_speeds(rows[1], report)
    lacks = _draw_torques(rows[2], report)
    figure.align_ylabels(rows)
    finish_times(rows, report.plan.t[-1], report.plan.reference.t[-1])
    legend_above(figure, _joint_keys(report), _LEFT, _LEGENDS)
    if lacks:
        legend_above(figure, lacks, _LEFT, 0.02)
    legend_above(figure, _draw_arm(figure.add_subplot(right[0]), report), _RIGHT, _LEGENDS)
    _draw_activations(figure, right[1], report)
    _head(figure, report)
    return figure


def _joint_keys(report: PlanReport) -> list[Artist]:
    """What the lines and markers over time mean."""
    joints: list[Artist] = [
        Line2D([], [], linewidth=LINE, label=name, **joint_line(j))
        for j, name in enumerate(report.feasibility.coordinates)
    ]
    knot = Line2D([], [], color=TEXT_COLOR, marker=".", markersize=5, linestyle="", label="knot")
    target = Line2D([], [], color=TEXT_COLOR, marker="D", markersize=6, fillstyle="none", linestyle="", label="target")
    return [*joints, knot, *([target] if report.movement.target_deg else [])]


def _draw_angles(panel: Axes, report: PlanReport) -> None:
    angles = np.rad2deg(report.plan.reference.q)
    _by_joint(panel, report, angles, np.rad2deg(report.plan.q))
    for j, target in enumerate(report.movement.target_deg):
        color = joint_line(j)["color"]
        panel.plot(report.plan.t[-1], target, marker="D", markersize=7, fillstyle="none", color=color, zorder=3)
    lowest, highest = (np.rad2deg(limit) for limit in report.angle_limits)
    limits = _draw_limits(panel, report, angles, lowest, highest, "°")
    _finish(panel, "joint angles", ANGLE, limits)


def _draw_speeds(panel: Axes, report: PlanReport) -> None:
    speeds = report.plan.reference.v
    _by_joint(panel, report, speeds, report.plan.v)
    limit = np.array(report.movement.speed_limit)
    limits = _draw_limits(panel, report, speeds, -limit, limit, " rad/s")
    _finish(panel, "joint speeds", "speed (rad/s)", limits)


def _draw_torques(panel: Axes, report: PlanReport) -> list[Artist]:
    """The torques of the plan. Where the muscles can exert less, the difference is hatched, as a legend explains."""
    feasibility, torques = report.feasibility, report.plan.reference.tau
    _by_joint(panel, report, torques, report.plan.tau)
    limit = np.array(report.movement.torque_limit)
    limits = _draw_limits(panel, report, torques, -limit, limit, " Nm")
    _finish(panel, "joint torques", "torque (Nm)", limits)
    lacks: list[Artist] = []
    for j, name in enumerate(feasibility.coordinates):
        lack = np.where(np.abs(feasibility.reserve[:, j]) > feasibility.negligible, feasibility.reserve[:, j], 0.0)
        if lack.any():
            area = panel.fill_between(feasibility.t, torques[:, j] - lack, torques[:, j])
            color = joint_line(j)["color"]
            area.set(facecolor=(color, 0.28), edgecolor=BAD_COLOR, linewidth=0, hatch=HATCHES[j % len(HATCHES)])
            area.set_label(f"{name}: the muscles lack up to {np.abs(lack).max():.3g} Nm")
            lacks.append(area)
    return lacks


def _by_joint(panel: Axes, report: PlanReport, samples: np.ndarray, knots: np.ndarray) -> None:
    """One line per joint through the samples (N, n_q) of the reference, with a dot at each knot (K, n_q)."""
    for j in range(samples.shape[1]):
        look = joint_line(j)
        panel.plot(report.plan.reference.t, samples[:, j], linewidth=LINE, **look)
        panel.plot(report.plan.t, knots[:, j], ".", color=look["color"], markersize=5)


def _draw_limits(
    panel: Axes, report: PlanReport, samples: np.ndarray, lowest: np.ndarray, highest: np.ndarray, unit: str
) -> str:
    """Draws the limits (n_q,) that a joint comes close to, and returns all limits as text."""
    panel.margins(y=0.08)
    room = _NEAR * np.ptp(panel.get_ylim())
    near_lowest, near_highest = lowest >= samples.min(axis=0) - room, highest <= samples.max(axis=0) + room
    for bounds, near in ((lowest, near_lowest), (highest, near_highest)):
        for j in np.flatnonzero(near).tolist():
            dots = (3.0 * j, (1.5, 4.5))  # so that the dots of two joints alternate
            panel.axhline(bounds[j], color=joint_line(j)["color"], linewidth=1.5, linestyle=dots, zorder=1)
    drawn = "dotted: " if near_lowest.any() or near_highest.any() else ""
    if np.ptp(highest) == 0.0 and np.all(lowest == -highest):
        return f"{drawn}limits ±{highest[0]:g}{unit}"
    each = zip(report.feasibility.coordinates, lowest, highest, strict=True)
    return f"{drawn}limits, " + ", ".join(f"{name} {low:zg} to {high:zg}{unit}" for name, low, high in each)


def _finish(panel: Axes, title: str, y: str, limits: str) -> None:
    finish_panel(panel, title, y=y)
    panel.set_title(limits, loc="right", fontsize=SMALL, color=NOTE_COLOR)


def _draw_arm(panel: Axes, report: PlanReport) -> list[Artist]:
    """The arm from the side at six times, the path of the hand, and the arm where it is nearest to the obstacle.

    Returns what a legend explains.
    """
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
        panel.annotate(text, hand[k], (7 * side, -4), textcoords="offset points", ha=sideways, fontsize=SMALL)
    shown: list[Artist] = [*panel.plot(*hand.T, color=HAND_COLOR, linewidth=2.5, zorder=4, label=HAND_PATH)]
    found = report.plan.verification
    if obstacle is not None and found.nearest_time is not None:
        x, y = view.project(np.array(obstacle.position))
        panel.add_patch(Circle((x, y), obstacle.radius, zorder=3, **OBSTACLE))
        nearest = np.array([np.interp(found.nearest_time, reference.t, angles) for angles in reference.q.T])
        for a, b, radius in view.outline(nearest):
            panel.fill(*capsule_edge(a, b, radius).T, zorder=2.5, **NEAREST)
        label = f"{NEAREST_NAME} {found.nearest_time:.2f} s"
        shown += [Patch(label=label, **NEAREST), Patch(label=OBSTACLE_NAME, **OBSTACLE)]
    panel.margins(0.08)
    panel.set_aspect("equal", adjustable="datalim")
    finish_panel(panel, "the arm from the side", *view.labels)
    return shown


def _draw_activations(figure: Figure, place: SubplotSpec, report: PlanReport) -> None:
    """The activations that static optimization finds. A bar above them marks the times when they are not enough."""
    feasibility = report.feasibility
    raster, bar = raster_places(place)
    panel = figure.add_subplot(raster)
    roles = muscle_roles(report.arm)
    image = draw_raster(panel, feasibility.t, feasibility.activation, report.arm, roles)
    label_roles(panel, roles)
    lacking = np.abs(feasibility.reserve).max(axis=1) > feasibility.negligible
    title = "activations needed"
    if lacking.any():
        above = panel.get_xaxis_transform()
        panel.fill_between(feasibility.t, 1.01, 1.05, where=lacking, color=BAD_COLOR, transform=above, clip_on=False)
        title += " (bar: not enough)"
    panel.set_title(title, loc="left", fontsize=FONT + 1, fontweight="bold", pad=12)
    panel.annotate(
        ROLES, (0.0, -0.23), xycoords="axes fraction", fontsize=SMALL, color=NOTE_COLOR, annotation_clip=False
    )
    activation_bar(figure, image, bar.get_position(figure).bounds)


def _head(figure: Figure, report: PlanReport) -> None:
    """What was planned, how it was found, and whether the muscles can do it."""
    plan, found, feasibility = report.plan, report.plan.verification, report.feasibility
    costs = ", ".join(f"{name} {value:z.3g}" for name, value in plan.costs.items())
    load = f" Load {report.load_mass:g} kg." if report.load_mass else ""
    clearance = f" Clearance {100 * found.clearance:z.2g} cm." if found.clearance is not None else ""
    facts = (
        f"{plan.solver}: {plan.status}, {plan.iterations} iterations, {plan.seconds:.2f} s without compilation. "
        f"{len(plan.t)} knots.{load}{clearance} Costs: {costs}.\n"
        f"Nearest to a limit: angle {np.rad2deg(found.angle_margin):z.1f}°, speed {found.speed_margin:z.2f} rad/s, "
        f"torque {found.torque_margin:z.2f} Nm. "
        f"Equations of motion hold to {found.speed_defect:.1g} rad/s and {found.acceleration_defect:.1g} rad/s²."
    )
    figure.text(0.02, 0.985, report.name, fontsize=HEADING, fontweight="bold", va="top")
    figure.text(0.02, 0.948, report.description, fontsize=FONT + 1, va="top")
    color = GOOD_COLOR if feasibility.feasible else BAD_COLOR
    figure.text(0.02, 0.926, feasibility.verdict, fontsize=FONT + 1, va="top", color=color, fontweight="bold")
    figure.text(0.02, 0.903, facts, fontsize=FONT, va="top", color=NOTE_COLOR, linespacing=1.35)
