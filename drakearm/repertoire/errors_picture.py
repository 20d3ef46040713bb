"""A picture of a policy's errors: over the workspace, and against duration, load, delay of the senses and strength."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drakearm.figures.side_view import SideView
from drakearm.figures.style import save_picture
from drakearm.repertoire.errors_table import REACHED, Act, Errors, held_out_errors
from drakearm.task import RandomStrength, TrackingTask

DELAYS = (0.0, 0.01, 0.02, 0.03, 0.04, 0.06)  # s
STRENGTHS = (0.8, 0.9, 1.0, 1.1, 1.2)
_GROUPS = 4  # of movements, by duration and by load
_DPI = 100


def write_errors_picture(file: Path, tasks: Sequence[TrackingTask], act: Act, errors: Errors, title: str) -> None:
    """Draws the errors of a policy in movements that it has not seen. errors: those of `held_out_errors`.

    The last two panels run all movements again, with senses that are late, and with muscles of other strength, which
    the policy is not told. Raises StorageError if the file cannot be written.
    """
    figure = Figure(figsize=(12, 7), layout="constrained")
    figure.suptitle(f"{title}: errors in {len(tasks)} movements never seen")
    panels = figure.subplot_mosaic("mmab;mmcd")
    _draw_map(panels["m"], tasks, errors)
    durations = np.array([task.reference.duration for task in tasks])
    _draw_groups(panels["a"], durations, errors, "time of movement and rest (s)")
    _draw_groups(panels["b"], np.array([task.load_mass for task in tasks]), errors, "load (kg), not told")
    late = [held_out_errors([replace(task, senses_delay=delay) for task in tasks], act) for delay in DELAYS]
    _draw_spread(panels["c"], [1e3 * delay for delay in DELAYS], late, "delay of the senses (ms)")
    _draw_spread(
        panels["d"], STRENGTHS, [_with_strength(tasks, act, each) for each in STRENGTHS], "strength of the muscles"
    )
    save_picture(figure, file, dpi=_DPI)


def _with_strength(tasks: Sequence[TrackingTask], act: Act, strength: float) -> Errors:
    changed = [replace(task, randomization=(RandomStrength(strength, strength),)) for task in tasks]
    return held_out_errors(changed, act, random=True)


def _draw_map(panel: Axes, tasks: Sequence[TrackingTask], errors: Errors) -> None:
    """Where the targets of the hand are, and how far from them it ends."""
    view = SideView(tasks[0].arm)
    targets = np.array([view.stick(task.reference.q[-1])[-1] for task in tasks])
    shoulder = view.stick(tasks[0].reference.q[0])[0]
    marks = panel.scatter(targets[:, 0], targets[:, 1], c=errors.hand, s=40, cmap="cividis", vmin=0.0, vmax=REACHED)
    panel.plot(*shoulder, "k+", markersize=12)
    panel.annotate("shoulder", shoulder, xytext=(6, 6), textcoords="offset points")
    panel.set(
        xlabel="x of the target (m)",
        ylabel="y of the target (m)",
        aspect="equal",
        title="distance of the hand at the end",
    )
    panel.figure.colorbar(marks, ax=panel, label="cm", extend="max", shrink=0.7)


def _draw_groups(panel: Axes, values: np.ndarray, errors: Errors, label: str) -> None:
    """The errors of movements that are alike in a quantity."""
    if np.ptp(values) == 0.0:
        _draw_spread(panel, [float(values[0])], [errors], label)
        return
    groups = np.array_split(np.argsort(values), min(_GROUPS, len(values)))
    _draw_spread(
        panel,
        [float(values[g].mean()) for g in groups],
        [Errors(errors.mean[g], errors.hand[g]) for g in groups],
        label,
    )


def _draw_spread(panel: Axes, values: Sequence[float], errors: Sequence[Errors], label: str) -> None:
    """Medians, and a bar up to what 95 % are below."""
    median = np.array([1e3 * np.median(each.mean) for each in errors])
    most = np.array([1e3 * np.percentile(each.mean, 95) for each in errors])
    panel.errorbar(values, median, [np.zeros_like(median), most - median], marker="o", capsize=3, color="black")
    panel.set(xlabel=label, ylabel="mean error (mrad)")
    panel.set_ylim(bottom=0.0)
    panel.set_title("median, and 95 % are below", fontsize="small")
