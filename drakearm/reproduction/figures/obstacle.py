"""Figure 9: the arm from the side with and without the bar, its joints, and its distance from the bar."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from drakearm.figures import SideView
from drakearm.figures.side_view import capsule_edge
from drakearm.figures.style import COLORS
from drakearm.reproduction.experiment import by_method, by_scenario
from drakearm.reproduction.figures.panels import REFERENCE_COLOR, Look, label_panel, legend_below, method_line
from drakearm.reproduction.trial import Outcome

if TYPE_CHECKING:
    from drakearm.reproduction.obstacle import Bar

_BAR: Look = {"facecolor": "#BBBBBB", "edgecolor": "#333333", "hatch": "////"}
_WITHOUT: Look = {"color": COLORS[4], "linestyle": (0, (3, 1.2))}  # the movement that does not know of the bar
_NEAREST = COLORS[3]  # the outline of the arm where it is nearest to the bar
_POSTURES = 6  # arms that are drawn


def draw_obstacle(outcomes: Sequence[Outcome], bar: "Bar") -> Figure:
    """One column per method. The runs are those of the first seed."""
    methods = by_method(outcomes)
    figure = Figure(figsize=(max(3.4 * len(methods), 6.0), 8.6), facecolor="white")
    ratios: Look = {"height_ratios": [2.0, 1.0, 1.0], "hspace": 0.38, "wspace": 0.25}
    grid = figure.add_gridspec(3, len(methods), left=0.08, right=0.98, top=0.95, bottom=0.125, **ratios)
    rows = [[figure.add_subplot(grid[i, k]) for k in range(len(methods))] for i in range(3)]
    for k, (method, some) in enumerate(methods.items()):
        firsts = {name: found[0] for name, found in by_scenario(some).items()}
        look = {True: method_line(method) | {"linestyle": "-"}, False: _WITHOUT}
        for name, outcome in sorted(firsts.items()):  # "obstacle" last, so in front
            avoids = name == "obstacle"
            _draw_side(rows[0][k], outcome, bar, avoids, look[avoids])
            for j, joint in enumerate(("elbow", "shoulder")):
                _draw_joint(rows[1][k], outcome, joint, look[avoids], width=1.0 - 0.4 * j)
            _draw_clearance(rows[2][k], outcome, bar, look[avoids])
        y = ("up (m)", "angle (°)", "clearance (cm)") if k == 0 else ("", "", "")
        label_panel(rows[0][k], str(method), "forward (m)", y[0])
        label_panel(rows[1][k], "elbow (upper), shoulder (lower)", "time (s)", y[1])
        label_panel(rows[2][k], "distance of the arm from the bar", "time (s)", y[2])
    keys: list[Artist] = [
        Line2D([], [], label=f"{method}, round the bar", **method_line(method) | {"linestyle": "-"})
        for method in methods
    ]
    keys += [
        Line2D([], [], label="without the bar", **_WITHOUT),
        Line2D([], [], color=REFERENCE_COLOR, linewidth=0.9, label="reference"),
        Patch(label="the bar", **_BAR),
        Patch(label="the arm nearest to it", color=_NEAREST, alpha=0.4, linewidth=0),
    ]
    legend_below(figure, keys, columns=4)
    return figure


def _draw_side(panel: Axes, outcome: Outcome, bar: "Bar", avoids: bool, look: Look) -> None:
    """The paths of the hand in all noisy runs, and the arm at some times of the run without noise."""
    view = SideView(outcome.task.arm, bar.obstacle)
    if avoids:
        center = view.project(np.array(bar.obstacle.position))
        panel.add_patch(Circle(tuple(center), bar.obstacle.radius, zorder=2, **_BAR))
        run = outcome.noise_free
        for k in np.linspace(0, len(run.t) - 1, _POSTURES).round().astype(int):
            panel.plot(*view.stick(run.q[k]).T, "-o", color="#999999", linewidth=1.2, markersize=2, zorder=1)
        t, distances = bar.clearance(run)
        nearest = run.q[np.abs(run.t - t[distances.min(axis=1).argmin()]).argmin()]
        for part in view.outline(nearest):
            panel.fill(*capsule_edge(*part).T, color=_NEAREST, alpha=0.4, linewidth=0, zorder=1.5)
    for run in outcome.noisy:
        path = np.array([view.project(point) for point in run.p_WH])
        panel.plot(*path.T, linewidth=0.9, zorder=3, **look)
    panel.set_aspect("equal", adjustable="datalim")


def _draw_joint(panel: Axes, outcome: Outcome, joint: str, look: Look, width: float) -> None:
    j = outcome.task.arm.coordinates.index(joint)
    for run in outcome.noisy:
        panel.plot(run.t, np.rad2deg(run.q[:, j]), linewidth=width, **look)
    reference = outcome.task.reference
    panel.plot(reference.t, np.rad2deg(reference.q[:, j]), color=REFERENCE_COLOR, linewidth=0.9)


def _draw_clearance(panel: Axes, outcome: Outcome, bar: "Bar", look: Look) -> None:
    """The distance of the nearest part in all noisy runs; below 0 it would be inside the bar."""
    for run in outcome.noisy:
        t, distances = bar.clearance(run)
        panel.plot(t[::5], 100 * distances.min(axis=1)[::5], linewidth=0.9, **look)
    panel.axhline(0.0, color="black", linewidth=1.0)
    low, high = panel.get_ylim()
    panel.axhspan(min(low, -1.0), 0.0, zorder=0, linewidth=0, facecolor="#BBBBBB", alpha=0.35)
    panel.set_ylim(min(low, -1.0), high)
