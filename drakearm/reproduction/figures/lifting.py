"""Figures 7 and 8: how far each load is lifted, the muscle load, and the activation of every muscle."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MultipleLocator

from drakearm.figures.muscle_roles import ROLES, muscle_roles
from drakearm.figures.raster import activation_bar, draw_raster, label_roles
from drakearm.figures.style import DEVIATION, LOAD, NOTE_COLOR, TIME, Look
from drakearm.model import Arm
from drakearm.model.recording import Recording
from drakearm.model.static_optimization import NEGLIGIBLE
from drakearm.reproduction.experiment import by_method
from drakearm.reproduction.figures.panels import (
    BAND,
    FONT,
    PAPER,
    REFERENCE,
    draw_band,
    label_panel,
    legend_below,
    method_keys,
    method_line,
    method_marker,
    reference_key,
)
from drakearm.reproduction.hand import desired_path
from drakearm.reproduction.lifting import LOADS, WEIGHTINGS, extensor_load, flexor_load
from drakearm.reproduction.muscle_load import THRESHOLD
from drakearm.reproduction.trial import Method, Outcome

Movements = Mapping[str, Sequence[Outcome]]
_ELBOW: Look = {"facecolor": NOTE_COLOR, "edgecolor": NOTE_COLOR}
_SHOULDER: Look = {"facecolor": "white", "edgecolor": NOTE_COLOR, "hatch": "////"}
_SATURATED = 80  # %, muscle load of the flexors with 10 kg and more, in the paper


def draw_lifting(movements: Movements) -> Figure:
    """One column per load; for both weightings the height of the hand and the angles of both joints."""
    figure = Figure(figsize=(10.0, 10.5), facecolor="white")
    grid = figure.add_gridspec(
        7, 5, left=0.085, right=0.985, top=0.935, bottom=0.09, height_ratios=[1, 1, 1, 0.45, 1, 1, 1]
    )
    grid.update(hspace=0.3, wspace=0.12)
    for block, weighting in enumerate(WEIGHTINGS):
        rows = [[figure.add_subplot(grid[4 * block + i, k]) for k in range(len(LOADS))] for i in range(3)]
        for k, load in enumerate(LOADS):
            _draw_load([row[k] for row in rows], movements.get(weighting.scenario(load), []), load)
        for i, row in enumerate(rows):
            _share_y(row)
            for panel in row:
                panel.tick_params(labelbottom=i == 2)
        top = rows[0][0].get_position().y1 + 0.028
        figure.text(0.012, top, weighting.label, fontsize=FONT + 2, fontweight="bold")
    methods = _methods(movements)
    keys: list[Artist] = [*method_keys(methods), reference_key()]
    keys.append(Patch(label=f"{DEVIATION}, with noise", **BAND))
    legend_below(figure, keys, columns=3)
    return figure


def _draw_load(panels: Sequence[Axes], outcomes: Sequence[Outcome], load: int) -> None:
    first = load == LOADS[0]
    labels = ("hand above\nits start (cm)", "elbow (°)", "shoulder (°)")
    for panel, label in zip(panels, labels, strict=True):
        title, x = (f"{load} kg" if panel is panels[0] else ""), (TIME if panel is panels[2] else "")
        label_panel(panel, title, x, label if first else "")
    for method, some in by_method(outcomes).items():
        joints = some[0].task.arm.coordinates
        angles = np.array([np.rad2deg(run.q) for outcome in some for run in outcome.noisy])
        look, t = method_line(method), some[0].noisy[0].t
        draw_band(panels[0], t, np.array([_height(o, run) for o in some for run in o.noisy]), **look)
        for panel, joint in zip(panels[1:], ("elbow", "shoulder"), strict=True):
            draw_band(panel, t, angles[:, :, joints.index(joint)], **look)
    if outcomes:
        task = outcomes[0].task
        run = outcomes[0].noise_free
        height = 100 * _up(task.arm, desired_path(task))
        panels[0].plot(run.t, height - height[0], **REFERENCE)
        for panel, joint in zip(panels[1:], ("elbow", "shoulder"), strict=True):
            reference = np.rad2deg(run.reference_q[:, task.arm.coordinates.index(joint)])
            panel.plot(run.t, reference, **REFERENCE)


def _height(outcome: Outcome, run: Recording) -> np.ndarray:
    """cm, of the hand above its start (N,)."""
    height = 100 * _up(outcome.task.arm, run.p_WH)
    return height - height[0]


def _up(arm: Arm, p: np.ndarray) -> np.ndarray:
    """The heights (N,) of points (N, 3)."""
    return -(p @ np.array(arm.gravity)) / np.linalg.norm(arm.gravity)


def draw_muscle_load(movements: Movements) -> Figure:
    """The muscle load of flexors and extensors against the load, for both weightings, above the lacking torque."""
    figure = Figure(figsize=(9.0, 6.6), facecolor="white")
    grid = figure.add_gridspec(2, 2, left=0.085, right=0.985, top=0.945, bottom=0.19, height_ratios=[2, 1])
    grid.update(hspace=0.32, wspace=0.12)
    for k, weighting in enumerate(WEIGHTINGS):
        found = {load: movements[weighting.scenario(load)] for load in LOADS if weighting.scenario(load) in movements}
        panel = figure.add_subplot(grid[0, k])
        _draw_loads(panel, found)
        label_panel(panel, weighting.label, "", "" if k else "muscle load (% of the time)")
        below = figure.add_subplot(grid[1, k], sharex=panel)
        _draw_lacking(below, found)
        label_panel(below, "", LOAD, "" if k else "lacking torque (Nm)")
    methods = _methods(movements)
    dot: Look = {"color": NOTE_COLOR, "marker": "o", "markersize": 5, "linestyle": ""}
    kinds: list[Artist] = [
        Line2D([], [], label="flexors", **dot),
        Line2D([], [], label="extensors", markerfacecolor="white", **dot),
        Line2D([], [], label="the paper: flexors saturate near 80 %", **PAPER),
        Patch(label="static strength: the elbow lacks", **_ELBOW),
        Patch(label="static strength: the shoulder lacks", **_SHOULDER),
    ]
    legend_below(figure, [*method_keys(methods), *kinds], columns=3)
    return figure


def _draw_loads(panel: Axes, found: Mapping[int, Sequence[Outcome]]) -> None:
    def draw(measure: Callable[[Outcome, Recording], float], **face: Any) -> None:
        for i, method in enumerate(_methods(found)):
            at = {load: by_method(some).get(method, []) for load, some in found.items()}
            loads = [load for load, some in at.items() if some]
            values = [[100 * measure(o, run) for o in at[load] for run in o.noisy] for load in loads]
            x = np.array(loads) + 0.18 * (i - 1)  # so that markers do not hide each other
            panel.plot(x, [np.mean(v) for v in values], linewidth=1.4, **method_line(method))
            look: Look = method_marker(method) | {"markersize": 5, "capsize": 2, "elinewidth": 0.8}
            panel.errorbar(x, [np.mean(v) for v in values], [np.std(v) for v in values], **look, **face)

    draw(flexor_load)
    draw(extensor_load, markerfacecolor="white")
    panel.plot([10, 20.5], [_SATURATED] * 2, **PAPER)
    panel.set(xlim=(0, 21), ylim=(-3, 100), xticks=LOADS)


def _draw_lacking(panel: Axes, found: Mapping[int, Sequence[Outcome]]) -> None:
    """The torque that the muscles lack for the plan, by static optimization."""
    for load, outcomes in found.items():
        feasibility = outcomes[0].feasibility
        lacking = dict(zip(feasibility.coordinates, np.abs(feasibility.reserve).max(axis=0), strict=True))
        for joint, aside, look in (("elbow", -0.2, _ELBOW), ("shoulder", 0.2, _SHOULDER)):
            if lacking[joint] > NEGLIGIBLE:
                panel.bar(load + aside, lacking[joint], 0.36, **look)


def draw_activations(movements: Movements) -> Figure:
    """The activation of all muscles over time: the mean over the noisy runs of the last method that there is."""
    method = _methods(movements)[-1]
    figure = Figure(figsize=(11.0, 6.6), facecolor="white")
    grid = figure.add_gridspec(2, 5, left=0.09, right=0.8, top=0.885, bottom=0.1, hspace=0.32, wspace=0.1)
    for row, weighting in enumerate(WEIGHTINGS):
        for k, load in enumerate(LOADS):
            panel = figure.add_subplot(grid[row, k])
            outcomes = by_method(movements.get(weighting.scenario(load), [])).get(method, [])
            if outcomes:
                arm, runs = outcomes[0].task.arm, [run for outcome in outcomes for run in outcome.noisy]
                roles, mean = muscle_roles(arm), np.mean([run.activation for run in runs], axis=0)
                image = draw_raster(panel, runs[0].t, mean, arm, roles)
                if k == len(LOADS) - 1:
                    label_roles(panel, roles)
            panel.set_title(f"{load} kg", loc="left", fontsize=FONT + 1, fontweight="bold")
            panel.xaxis.set_major_locator(MultipleLocator(0.5))
            panel.tick_params(labelleft=k == 0, labelbottom=row == 1)
            panel.set_xlabel(TIME if row else "", fontsize=FONT)
        top = grid[row, 0].get_position(figure).y1 + 0.045
        figure.text(0.012, top, f"{method}, {weighting.label}", fontsize=FONT + 2, fontweight="bold")
    bar = activation_bar(figure, image, (0.915, 0.1, 0.013, 0.785))
    bar.axhline(THRESHOLD, color="white", linewidth=1.5)
    figure.text(0.09, 0.012, f"{ROLES}. White line: {THRESHOLD:g}, the threshold of the muscle load.", fontsize=FONT)
    return figure


def _methods(movements: Mapping[Any, Sequence[Outcome]]) -> list[Method]:
    return list(by_method([outcome for some in movements.values() for outcome in some]))


def _share_y(row: Sequence[Axes]) -> None:
    limits = np.array([panel.get_ylim() for panel in row])
    for panel in row:
        panel.set_ylim(limits[:, 0].min(), limits[:, 1].max())
        panel.tick_params(labelleft=panel is row[0])
