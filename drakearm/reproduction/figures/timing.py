"""Figures 5 and 6: joint angles of the timed movements, what perturbations do to them, and how they were learned."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import NullFormatter
from scipy.stats import t as student

from drakearm.figures.style import TIME
from drakearm.reproduction.experiment import by_method, by_seed, end_error
from drakearm.reproduction.figures.panels import (
    BAND,
    PAPER,
    REFERENCE,
    label_panel,
    legend_below,
    method_keys,
    method_line,
    method_marker,
    reference_key,
)
from drakearm.reproduction.timing import LEARNED
from drakearm.reproduction.trial import Method, Outcome

_CONFIDENCE, _FEWEST = 0.95, 3  # two trainings say next to nothing about the confidence of their mean
_PAPER_BATCHES = 150


def draw_timing(movements: Mapping[str, Sequence[Outcome]]) -> Figure:
    """One column per movement: elbow, shoulder, and the errors at the end of every perturbed run."""
    figure = Figure(figsize=(10.0, 7.6), facecolor="white")
    n = len(movements)
    grid = figure.add_gridspec(3, n, left=0.075, right=0.985, top=0.95, bottom=0.135, hspace=0.42, wspace=0.28)
    rows = np.array([[figure.add_subplot(grid[i, k]) for k in range(n)] for i in range(3)])
    for k, (name, outcomes) in enumerate(movements.items()):
        joints = outcomes[0].task.arm.coordinates
        for i, joint in enumerate(("elbow", "shoulder")):
            _draw_joint(rows[i, k], outcomes, joints.index(joint))
            label_panel(rows[i, k], name if i == 0 else "", TIME, "" if k else f"{joint} (°)")
        _draw_end_errors(rows[2, k], outcomes)
        label_panel(rows[2, k], "", "perturbed runs, sorted (%)", "" if k else "error at the end (rad)")
    _share_limits(rows)
    methods = list(by_method([outcome for some in movements.values() for outcome in some]))
    perturbed = Line2D(
        [], [], color=method_line(methods[-1])["color"], linewidth=0.6, label=f"perturbed, {methods[-1]}"
    )
    paper = Line2D([], [], label="0.1 rad (the paper: 44 of 48 below)", **PAPER)
    legend_below(figure, [*method_keys(methods), reference_key(), perturbed, paper], columns=3)
    return figure


def _draw_joint(panel: Axes, outcomes: Sequence[Outcome], joint: int) -> None:
    """The noise-free runs of the first seed, and the perturbed runs of the last method behind them."""
    firsts = {method: some[0] for method, some in by_method(outcomes).items()}
    last = list(firsts.values())[-1]
    for run in last.perturbed:
        color = method_line(last.trial.method)["color"]
        panel.plot(run.t, np.rad2deg(run.q[:, joint]), color=color, linewidth=0.5, alpha=0.5)
    reference = last.task.reference
    panel.plot(reference.t, np.rad2deg(reference.q[:, joint]), **REFERENCE)
    for method, outcome in firsts.items():
        run = outcome.noise_free
        panel.plot(run.t, np.rad2deg(run.q[:, joint]), linewidth=1.5, **method_line(method))


def _draw_end_errors(panel: Axes, outcomes: Sequence[Outcome]) -> None:
    """The error of the worse joint at the end of each perturbed run, from the best to the worst, for each method."""
    shown = [LEARNED, 0.1 * LEARNED]
    for method, some in by_method(outcomes).items():
        errors = np.sort([end_error(run) for outcome in some for run in outcome.perturbed])
        at = 100 * (np.arange(len(errors)) + 0.5) / max(len(errors), 1)
        panel.plot(at, errors, markersize=3.5, markerfacecolor="none", **method_marker(method))
        shown += list(errors)
    panel.axhline(LEARNED, **PAPER)
    panel.set(xlim=(0, 100), xticks=(0, 50, 100), ylim=(0.8 * min(shown), 1.5 * max(shown)))
    _log_scale(panel)


def _log_scale(panel: Axes) -> None:
    panel.set_yscale("log")
    panel.yaxis.set_major_formatter("{x:g}")
    panel.yaxis.set_minor_formatter(NullFormatter())


def _share_limits(rows: np.ndarray) -> None:
    """The same vertical limits for all panels of a row."""
    for row in rows:
        limits = np.array([panel.get_ylim() for panel in row])
        for panel in row:
            panel.set_ylim(limits[:, 0].min(), limits[:, 1].max())
    for panel in rows[1]:  # so that a shoulder that is still does not look as if it shook
        low, high = panel.get_ylim()
        panel.set_ylim(min(low, -5.0), max(high, 5.0))


def draw_learning(movements: Mapping[str, Sequence[Outcome]]) -> Figure:
    """One panel per movement: the tracking error after each batch, mean over the seeds with its confidence band."""
    figure = Figure(figsize=(10.0, 3.6), facecolor="white")
    panels = figure.subplots(1, len(movements), sharey=True, squeeze=False)[0]
    figure.subplots_adjust(left=0.075, right=0.985, top=0.91, bottom=0.27, wspace=0.1)
    for panel, (name, outcomes) in zip(panels, movements.items(), strict=True):
        for method, some in by_method(outcomes).items():
            _draw_curve(panel, method, [seed[0] for seed in by_seed(some)])
        panel.axhline(LEARNED, **PAPER)
        panel.axvline(_PAPER_BATCHES, **PAPER)
        _log_scale(panel)
        label_panel(panel, name, "batch", "" if panel is not panels[0] else "tracking error (rad)")
    methods = by_method([outcome for some in movements.values() for outcome in some])
    seeds = len({outcome.trial.seed for some in movements.values() for outcome in some})
    keys: list[Artist] = [*method_keys(list(methods))]
    if seeds >= _FEWEST:
        text = f"{_CONFIDENCE:.0%} confidence of the mean of {seeds} trainings"
        keys.append(Patch(label=text, **BAND))
    keys.append(Line2D([], [], label="the paper: below 0.1 rad after about 150 of 200 batches", **PAPER))
    legend_below(figure, keys, columns=2)
    return figure


def _draw_curve(panel: Axes, method: Method, seeds: Sequence[Outcome]) -> None:
    """The geometric mean of the seeds' errors, and its confidence interval (Student's t of their logarithms)."""
    curves = [outcome.learning_curve for outcome in seeds if outcome.learning_curve is not None]
    shortest = min(len(curve["batch"]) for curve in curves)
    batch = curves[0]["batch"][:shortest]
    errors = np.log([curve["tracking_error"][:shortest] for curve in curves])
    mean = errors.mean(axis=0)
    panel.plot(batch, np.exp(mean), linewidth=1.6, **method_line(method))
    if len(errors) >= _FEWEST:
        quantile = student.ppf(0.5 + 0.5 * _CONFIDENCE, len(errors) - 1)
        half = quantile * errors.std(axis=0, ddof=1) / np.sqrt(len(errors))
        band = np.exp(mean - half), np.exp(mean + half)
        panel.fill_between(batch, *band, **BAND | {"color": method_line(method)["color"]})
