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
from drakearm.figures.style import (
    ANGLE,
    ARM_COLOR,
    CLEARANCE,
    COLORS,
    DASHES,
    FAINT_COLOR,
    NEAREST,
    OBSTACLE,
    OBSTACLE_NAME,
    TEXT_COLOR,
    TIME,
    Look,
)
from drakearm.reproduction.experiment import by_method, by_scenario
from drakearm.reproduction.figures.panels import REFERENCE, label_panel, legend_below, method_line, reference_key
from drakearm.reproduction.trial import Outcome

if TYPE_CHECKING:
    from drakearm.reproduction.obstacle import Bar

_WITHOUT: Look = {"color": COLORS[4], "linestyle": DASHES[3]}  # the movement that does not know of the bar
_CONTACT: Look = {"facecolor": FAINT_COLOR, "alpha": 0.3, "linewidth": 0}  # no clearance
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
        y = ("y (m)", ANGLE, CLEARANCE) if k == 0 else ("", "", "")
        label_panel(rows[0][k], str(method), "x (m)", y[0])
        label_panel(rows[1][k], "elbow (upper), shoulder (lower)", TIME, y[1])
        label_panel(rows[2][k], "clearance", TIME, y[2])
    keys: list[Artist] = [
        Line2D([], [], label=f"{method}, round the obstacle", **method_line(method) | {"linestyle": "-"})
        for method in methods
    ]
    keys += [
        Line2D([], [], label="without the obstacle", **_WITHOUT),
        reference_key(),
        Patch(label=OBSTACLE_NAME, **OBSTACLE),
        Patch(label="arm when it is nearest to it", **NEAREST),
    ]
    legend_below(figure, keys, columns=4)
    return figure


def _draw_side(panel: Axes, outcome: Outcome, bar: "Bar", avoids: bool, look: Look) -> None:
    """The paths of the hand in all noisy runs, and the arm at some times of the run without noise."""
    view = SideView(outcome.task.arm, bar.obstacle)
    if avoids:
        center = view.project(np.array(bar.obstacle.position))
        panel.add_patch(Circle(tuple(center), bar.obstacle.radius, zorder=2, **OBSTACLE))
        run = outcome.noise_free
        for k in np.linspace(0, len(run.t) - 1, _POSTURES).round().astype(int):
            panel.plot(*view.stick(run.q[k]).T, "-o", color=ARM_COLOR, alpha=0.5, linewidth=1.2, markersize=2, zorder=1)
        t, distances = bar.clearance(run)
        nearest = run.q[np.abs(run.t - t[distances.min(axis=1).argmin()]).argmin()]
        for part in view.outline(nearest):
            panel.fill(*capsule_edge(*part).T, zorder=1.5, **NEAREST)
    for run in outcome.noisy:
        path = np.array([view.project(point) for point in run.p_WH])
        panel.plot(*path.T, linewidth=0.9, zorder=3, **look)
    panel.set_aspect("equal", adjustable="datalim")


def _draw_joint(panel: Axes, outcome: Outcome, joint: str, look: Look, width: float) -> None:
    j = outcome.task.arm.coordinates.index(joint)
    for run in outcome.noisy:
        panel.plot(run.t, np.rad2deg(run.q[:, j]), linewidth=width, **look)
    reference = outcome.task.reference
    panel.plot(reference.t, np.rad2deg(reference.q[:, j]), **REFERENCE | {"linewidth": 0.9})


def _draw_clearance(panel: Axes, outcome: Outcome, bar: "Bar", look: Look) -> None:
    """The distance of the nearest part in all noisy runs; below 0 it would be inside the bar."""
    for run in outcome.noisy:
        t, distances = bar.clearance(run)
        panel.plot(t[::5], 100 * distances.min(axis=1)[::5], linewidth=0.9, **look)
    panel.axhline(0.0, color=TEXT_COLOR, linewidth=1.0)
    low, high = panel.get_ylim()
    panel.axhspan(min(low, -1.0), 0.0, zorder=0, **_CONTACT)
    panel.set_ylim(min(low, -1.0), high)
