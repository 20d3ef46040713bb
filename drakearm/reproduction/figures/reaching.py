"""Figure 4: paths of the hand, speed profiles and their spread, beside minimum jerk and people."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from drakearm.figures.style import COLORS, DEVIATION, HAND_PATH, NOTE_COLOR, TEXT_COLOR, Look
from drakearm.reproduction.figures.panels import (
    BAND,
    FONT,
    PAPER,
    draw_band,
    label_panel,
    legend_below,
    method_line,
    method_marker,
)
from drakearm.reproduction.minimum_jerk import minimum_jerk_profile
from drakearm.reproduction.people import PEOPLE, load_people
from drakearm.reproduction.speed_profile import PHASES, correlation
from drakearm.reproduction.trial import Method

if TYPE_CHECKING:
    from drakearm.reproduction.reaching import Reaches

_PEOPLE: Look = {"color": COLORS[5], "linestyle": (0, (4, 1.2, 1, 1.2))}
_JERK: Look = {"color": TEXT_COLOR, "linewidth": 1.3, "linestyle": "-"}
_SHOWN = "single_peaked_under_1.2s"  # the group of people whose profile is drawn
_TOLERANCE = 1.0  # cm, of the paper: 10 % of the amplitude
_PAPER_MEAN, _PAPER_SPREAD = 0.91, 0.78


def draw_reaching(measured: Mapping[Method, "list[Reaches]"]) -> Figure:
    """One row per method, and below how similar its profiles are to those of people."""
    height = 2.7 * len(measured) + 3.2
    figure = Figure(figsize=(9.0, height), facecolor="white")
    top, bottom = 1 - 0.5 / height, 2.95 / height
    grid = figure.add_gridspec(
        len(measured), 3, left=0.08, right=0.985, top=top, bottom=bottom, hspace=0.5, wspace=0.36
    )
    for i, (method, seeds) in enumerate(measured.items()):
        _draw_paths(figure.add_subplot(grid[i, 0]), method, seeds)
        _draw_speeds(figure.add_subplot(grid[i, 1]), method, seeds)
        _draw_spreads(figure.add_subplot(grid[i, 2]), method, seeds)
    row = figure.add_gridspec(1, 2, left=0.24, right=0.985, top=2.15 / height, bottom=1.2 / height, wspace=0.1)
    panels = [figure.add_subplot(row[0])]
    panels.append(figure.add_subplot(row[1], sharey=panels[0]))
    _draw_similarity(panels, measured)
    keys: list[Artist] = [Line2D([], [], markersize=5, label=str(m), **method_marker(m)) for m in measured]
    ceiling: Look = {"color": TEXT_COLOR, "marker": "|", "markersize": 12, "markeredgewidth": 2.2, "linestyle": ""}
    keys += [
        Line2D([], [], label="minimum jerk, cut alike", **_JERK),
        Line2D([], [], linewidth=1.6, label=f"people, {PEOPLE[_SHOWN]}", **_PEOPLE),
        Patch(label=DEVIATION, **BAND),
        Line2D([], [], label="ceiling: one person against others", **ceiling),
        Line2D([], [], label="the paper, against other people", **PAPER),
    ]
    legend_below(figure, keys, columns=3)
    return figure


def _draw_paths(panel: Axes, method: Method, seeds: "list[Reaches]") -> None:
    """The paths of the hand from its place at the start, around the targets."""
    for reach in seeds[0].runs:  # more would hide each other
        p = 100 * (reach.recording.p_WH - reach.start)[:, :2]  # the arm moves in the plane across z
        panel.plot(*p.T, color=method_line(method)["color"], linewidth=0.5, alpha=0.6)
        panel.plot(*p[-1], ".", color=TEXT_COLOR, markersize=1.8, zorder=3)
    for target in np.unique([100 * (reach.target - reach.start)[:2] for reach in seeds[0].runs], axis=0):
        panel.add_patch(Circle(target, _TOLERANCE, fill=False, edgecolor=TEXT_COLOR, linewidth=1.0, zorder=4))
    panel.set_aspect("equal")
    panel.set(xlim=(-12.5, 12.5), ylim=(-12.5, 12.5), xticks=(-10, -5, 0, 5, 10), yticks=(-10, -5, 0, 5, 10))
    label_panel(panel, f"{method}\n{HAND_PATH}", "x from the start (cm)", "y from the start (cm)")


def _draw_speeds(panel: Axes, method: Method, seeds: "list[Reaches]") -> None:
    people = load_people(_SHOWN)
    runs = np.array([run.profile.speed for reaches in seeds for run in reaches.runs])
    draw_band(panel, PHASES, runs, **method_line(method) | {"linestyle": "-"})
    panel.plot(PHASES, minimum_jerk_profile().speed, **_JERK)
    panel.plot(PHASES, people.mean, linewidth=1.6, **_PEOPLE)
    panel.set(xlim=(0, 1), ylim=(0, 1.08))
    label_panel(panel, "speed profile", "time / duration", "speed / peak speed")


def _draw_spreads(panel: Axes, method: Method, seeds: "list[Reaches]") -> None:
    people = load_people(_SHOWN)
    for reaches in seeds:
        panel.plot(
            PHASES, reaches.spread, linewidth=1.8 if len(seeds) == 1 else 1.0, color=method_line(method)["color"]
        )
    panel.plot(PHASES, people.within, linewidth=1.6, **_PEOPLE)
    panel.set(xlim=(0, 1))
    panel.set_ylim(bottom=0)
    label_panel(panel, "spread between runs", "time / duration", "deviation / peak speed")


def _draw_similarity(panels: list[Axes], measured: Mapping[Method, "list[Reaches]"]) -> None:
    """Correlations of the mean and of the spread, one marker per seed; to the right is more similar."""
    jerk, people = minimum_jerk_profile(), [load_people(group) for group in PEOPLE]
    names = ["minimum jerk", *(f"people, {p.label}" for p in people)]
    for i, (method, seeds) in enumerate(measured.items()):
        offset = 0.22 * (i - (len(measured) - 1) / 2)
        for reaches in seeds:
            means = [correlation(reaches.mean, other) for other in (jerk.speed, *(p.mean for p in people))]
            spreads = [np.nan, *(correlation(reaches.spread, p.within) for p in people)]
            for panel, values in zip(panels, (means, spreads), strict=True):
                panel.plot(values, np.arange(3) + offset, markersize=5, **method_marker(method))
    for k, p in enumerate(people, start=1):
        panels[0].plot([p.ceiling] * 2, [k - 0.38, k + 0.38], color=TEXT_COLOR, linewidth=2.2, zorder=1)
    for panel, paper in zip(panels, (_PAPER_MEAN, _PAPER_SPREAD), strict=True):
        panel.plot([paper] * 2, [0.5, 2.6], zorder=1, **PAPER)
        panel.set_xlim(right=1.0)
    panels[0].set(yticks=range(3), yticklabels=names, ylim=(2.6, -0.6))
    panels[1].tick_params(labelleft=False)
    note: Look = {"fontsize": FONT - 1, "color": NOTE_COLOR, "va": "center", "ha": "center"}
    panels[1].text(0.5, 0.82, "(minimum jerk has no spread)", transform=panels[1].transAxes, **note)
    label_panel(panels[0], "similarity of the mean profile to", "correlation")
    label_panel(panels[1], "similarity of the spread", "correlation")
