"""A picture of a policy's errors: over the workspace, and against all that makes a movement difficult."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from drakearm.figures.side_view import SideView
from drakearm.figures.style import (
    FONT,
    HAND_END_ERROR,
    LOAD,
    NOTE_COLOR,
    POLICY,
    SMALL,
    STATIC,
    STATIC_NAME,
    TEXT_COLOR,
    Look,
    finish_panel,
    legend_above,
    literal_text,
    save_picture,
    without_line,
)
from drakearm.repertoire.errors_table import REACHED, Act, Errors, held_out_errors
from drakearm.repertoire.scatter import NOISE, Fitts
from drakearm.task import Randomization, RandomMotorNoise, RandomStrength, TrackingTask

DELAYS = (0.0, 0.01, 0.02, 0.03, 0.04, 0.06)  # s
STRENGTHS = (0.8, 0.9, 1.0, 1.1, 1.2)
NOISES = (0.0, 0.1, 0.2, 0.3, 0.5)  # standard deviation of an excitation's noise over the excitation
_GROUPS = 4  # of movements, by duration and by load
_BARS = "Points are medians, and 95 % of the movements are below the upper end of a bar."
_DPI = 100


@literal_text
def write_errors_picture(
    file: Path,
    tasks: Sequence[TrackingTask],
    act: Act,
    errors: Errors,
    static: Errors,
    law: Fitts | None,
    title: str,
) -> None:
    """Draws the errors of a policy in movements that it has not seen.

    errors, static: those of `held_out_errors` for the policy and for static optimization. law: the result of `fitts`.
    Some panels run all movements again: with late senses, with muscles of other strength and with motor noise, none of
    which the policy is told. Raises StorageError if the file cannot be written.
    """
    figure = Figure(figsize=(15, 8), facecolor="white")
    figure.suptitle(f"{title}: errors in {len(tasks)} movements never seen", fontsize=FONT + 3, fontweight="bold")
    layout: Look = {"left": 0.05, "right": 0.985, "top": 0.83, "bottom": 0.08, "wspace": 0.42, "hspace": 0.42}
    panels = figure.subplot_mosaic("mmabe;mmcdf", gridspec_kw=layout)
    _draw_map(panels["m"], tasks, errors)
    durations, loads = (np.array([get(task) for task in tasks]) for get in (_duration, _load))
    for name, values, label in (("a", durations, "time of movement and rest (s)"), ("b", loads, f"{LOAD}, not told")):
        _draw_groups(panels[name], values, errors, label)
        _draw_groups(panels[name], values, static, label, look=STATIC)
    keys = [Line2D([], [], label=label, **look) for label, look in (("policy", POLICY), (STATIC_NAME, STATIC))]
    legend_above(figure, keys, panels["a"].get_position().x0, 0.885)
    figure.text(panels["a"].get_position().x0, 0.925, _BARS, fontsize=SMALL, color=NOTE_COLOR)
    late = [held_out_errors([replace(task, senses_delay=delay) for task in tasks], act) for delay in DELAYS]
    _draw_spread(panels["c"], [1e3 * delay for delay in DELAYS], late, "delay of the senses (ms)")
    weak = [_with(tasks, act, RandomStrength(strength, strength)) for strength in STRENGTHS]
    _draw_spread(panels["d"], STRENGTHS, weak, "muscle strength (1 = the arm's)")
    noisy = [_with(tasks, act, RandomMotorNoise(share)) for share in NOISES]
    _draw_spread(panels["e"], [100.0 * share for share in NOISES], noisy, "motor noise (% of the excitation)")
    _draw_fitts(panels["f"], law)
    save_picture(figure, file, dpi=_DPI)


def _duration(task: TrackingTask) -> float:
    return task.reference.duration


def _load(task: TrackingTask) -> float:
    return task.load_mass


def _with(tasks: Sequence[TrackingTask], act: Act, change: Randomization) -> Errors:
    return held_out_errors([replace(task, randomization=(change,)) for task in tasks], act, random=True)


def _draw_fitts(panel: Axes, law: Fitts | None) -> None:
    """The shortest time to a target against its difficulty, and the line through these points."""
    title = f"Fitts' law, {100 * NOISE:.0f} % noise"
    if law is None:
        panel.text(0.5, 0.5, "no target can be hit", ha="center", transform=panel.transAxes)
    else:
        panel.plot(law.difficulty, law.duration, **without_line(POLICY))
        ends = np.array([law.difficulty.min(), law.difficulty.max()])
        panel.plot(ends, law.intercept + law.slope * ends, color=TEXT_COLOR)
        panel.set_ylim(bottom=0.0)
        title += f"\n{law.intercept:z.2f} s + {law.slope:z.2f} s/bit, r = {law.correlation:z.2f}"
    finish_panel(panel, title, "difficulty of the target (bits)", "shortest time (s)", SMALL)


def _draw_map(panel: Axes, tasks: Sequence[TrackingTask], errors: Errors) -> None:
    """Where the targets of the hand are, and how far from them it ends."""
    view = SideView(tasks[0].arm)
    targets = np.array([view.stick(task.reference.q[-1])[-1] for task in tasks])
    shoulder = view.stick(tasks[0].reference.q[0])[0]
    x, y = targets.T
    look: Look = {"cmap": "cividis_r", "edgecolors": TEXT_COLOR, "linewidths": 0.4, "vmin": 0.0, "vmax": REACHED}
    marks = panel.scatter(x, y, c=errors.hand, s=40, **look)
    panel.plot(*shoulder, "+", color=TEXT_COLOR, markersize=12)
    joint = tasks[0].arm.coordinates[0]
    panel.annotate(joint, shoulder, xytext=(8, 0), textcoords="offset points", va="center", fontsize=SMALL)
    panel.margins(0.08)
    panel.set_aspect("equal")
    finish_panel(panel, "targets", *view.labels)
    bar = panel.figure.colorbar(marks, ax=panel, extend="max", orientation="horizontal", shrink=0.8, pad=0.14)
    bar.set_label(HAND_END_ERROR, fontsize=FONT)


def _draw_groups(panel: Axes, values: np.ndarray, errors: Errors, label: str, look: Look = POLICY) -> None:
    """The errors of movements that are alike in a quantity."""
    if np.ptp(values) == 0.0:
        _draw_spread(panel, [float(values[0])], [errors], label, look)
        return
    groups = np.array_split(np.argsort(values), min(_GROUPS, len(values)))
    each = [Errors(errors.mean[g], errors.hand[g]) for g in groups]
    _draw_spread(panel, [float(values[g].mean()) for g in groups], each, label, look)


def _draw_spread(
    panel: Axes, values: Sequence[float], errors: Sequence[Errors], label: str, look: Look = POLICY
) -> None:
    """Medians, and a bar up to what 95 % are below."""
    median = np.array([1e3 * np.median(each.mean) for each in errors])
    most = np.array([1e3 * np.percentile(each.mean, 95) for each in errors])
    panel.errorbar(values, median, [np.zeros_like(median), most - median], capsize=3, **look)
    panel.set_ylim(0.0, max(panel.dataLim.y1, 1.05 * float(most.max())))
    finish_panel(panel, "", label, "mean error (mrad)", SMALL)
