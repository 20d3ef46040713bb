"""A picture of a movement: what the arm, its hand and its muscles did in a run, and in the runs with noise."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from scipy.integrate import cumulative_trapezoid

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
from drakearm.model import MakeTorqueArm
from drakearm.model.clearance import Clearance
from drakearm.model.recording import Recording
from drakearm.model.skeleton import hand_motion
from drakearm.task import TrackingTask

_DPI = 100
_NEAR_GOAL = 0.01  # m, radius of the circle around the goal of the hand
_DASHES: tuple[Any, ...] = ("-", (0, (7, 1.5)), (0, (7, 1.5, 1.5, 1.5)))  # of the joints, for those who see no colors
_REFERENCE: dict[str, Any] = {"linewidth": 1.4, "linestyle": (0, (1, 1.6)), "zorder": 3}
_DARK = 0.4  # brightness of the reference's color over that of the line which follows it
_ENERGY, _WORK = "#7A1F5C", "#5B8F29"
_SPREAD = 0.22  # opacity


class Movement(NamedTuple):
    """What is drawn. metrics: what `evaluation_metrics` finds in the recordings. title, description: of the task."""

    task: TrackingTask
    recording: Recording  # without noise
    noisy: Sequence[Recording]
    metrics: Mapping[str, Any]
    title: str
    description: str = ""

    @property
    def end(self) -> float:
        """s, when the reference comes to rest for good."""
        moving = np.flatnonzero(np.abs(self.recording.reference_v).max(axis=1) > 1e-6)
        return float(self.recording.t[min(moving[-1] + 1, len(self.recording.t) - 1)]) if len(moving) else 0.0


@literal_text
def write_movement_picture(movement: Movement, file: Path) -> None:
    """Draws a movement into a .png. Raises StorageError if it cannot be written, and leaves the earlier one then."""
    save_picture(draw_movement(movement), file, dpi=_DPI)


@literal_text
def draw_movement(movement: Movement) -> Figure:
    """Over time on the left: angles, errors, muscle torques and the hand's speed. On the right: arm, hand, muscles."""
    figure = Figure(figsize=(13.5, 11.0), facecolor="white")
    left = figure.add_gridspec(4, 1, left=0.065, right=0.485, top=0.835, bottom=0.05, hspace=0.36)
    right = figure.add_gridspec(
        3, 1, left=0.58, right=0.965, top=0.835, bottom=0.05, hspace=0.34, height_ratios=(1.15, 1.3, 0.75)
    )
    views = right[0].subgridspec(1, 2, wspace=0.28)
    rows = [figure.add_subplot(left[i]) for i in range(4)]
    energy = figure.add_subplot(right[2])
    _draw_angles(rows[0], movement)
    _draw_errors(rows[1], movement)
    _draw_torques(rows[2], movement)
    _draw_hand_speed(rows[3], movement)
    _draw_energy(energy, movement)
    for panel in (*rows, energy):
        finish_time_axis(panel, movement.end, float(movement.recording.t[-1]))
    for panel in (rows[3], energy):
        panel.set_xlabel("time (s)", fontsize=FONT)
    _draw_arm(figure.add_subplot(views[0]), movement)
    _draw_hand_path(figure.add_subplot(views[1]), movement)
    raster = figure.add_subplot(right[1])
    activation = movement.recording.activation
    top = float(np.clip(np.ceil(10.0 * activation.max()) / 10.0, 0.1, 1.0))  # weak movements would be all gray
    draw_raster(raster, movement.recording.t, activation, movement.task.arm.muscle_names, top)
    _title(raster, "activations")
    _head(figure, movement)
    return figure


def _draw_angles(panel: Axes, movement: Movement) -> None:
    _title(panel, "joint angles (°)")
    _by_joint(panel, movement, lambda run: np.rad2deg(run.q))
    _references(panel, movement, np.rad2deg(movement.recording.reference_q))


def _draw_errors(panel: Axes, movement: Movement) -> None:
    _title(panel, "tracking errors (rad): angle minus reference")
    _by_joint(panel, movement, lambda run: run.q - run.reference_q)


def _draw_torques(panel: Axes, movement: Movement) -> None:
    _title(panel, "torques of the muscles on the joints (Nm)")
    _by_joint(panel, movement, lambda run: run.muscle_torque)
    _references(panel, movement, movement.task.reference.tau[-len(movement.recording.t) :])


def _draw_hand_speed(panel: Axes, movement: Movement) -> None:
    _title(panel, "speed of the hand (m/s)")
    _line_and_spread(panel, movement, lambda run: run.hand_speed, color=HAND_COLOR)
    speed = np.linalg.norm(_reference_hand(movement)[1], axis=1)
    panel.plot(movement.recording.t, speed, color="black", **_REFERENCE)


def _draw_energy(panel: Axes, movement: Movement) -> None:
    """Energy that was used and work that was done up to each time."""

    def integral(power: np.ndarray, run: Recording) -> np.ndarray:
        return cumulative_trapezoid(power.sum(axis=1), run.t, initial=0.0)

    _title(panel, "energy of the muscles (J)")
    used = _line_and_spread(panel, movement, lambda run: integral(run.metabolic_power, run), color=_ENERGY)
    used.set_label("metabolic")
    done = _line_and_spread(
        panel,
        movement,
        lambda run: integral(run.fiber_power + run.tendon_power, run),
        color=_WORK,
        linestyle=_DASHES[1],
    )
    done.set_label("work on the joints")
    _legend_above(panel, [used, done])


def _by_joint(panel: Axes, movement: Movement, quantity: Any) -> None:
    """One line per joint with its spread. quantity: of a recording, (N, n_q)."""
    for j in range(len(movement.task.arm.coordinates)):
        dashes = _DASHES[j % len(_DASHES)]
        _line_and_spread(panel, movement, lambda run, j=j: quantity(run)[:, j], color=joint_color(j), linestyle=dashes)


def _references(panel: Axes, movement: Movement, samples: np.ndarray) -> None:
    """One dotted line per joint, in a dark tone of its color. samples: (N, n_q)."""
    for j in range(samples.shape[1]):
        color = tuple(_DARK * np.array(to_rgb(joint_color(j))))
        panel.plot(movement.recording.t, samples[:, j], color=color, **_REFERENCE)


def _line_and_spread(panel: Axes, movement: Movement, quantity: Any, **style: Any) -> Line2D:
    """A line of the run without noise, and the range of the runs with noise. quantity: of a recording, (N,)."""
    t = movement.recording.t
    if movement.noisy:
        runs = np.array([quantity(run) for run in movement.noisy])
        lowest, highest = runs.min(axis=0), runs.max(axis=0)
        panel.fill_between(t, lowest, highest, color=style["color"], alpha=_SPREAD, linewidth=0, zorder=1.5)
    (line,) = panel.plot(t, quantity(movement.recording), linewidth=2.0, zorder=2, **style)
    return line


def _draw_arm(panel: Axes, movement: Movement) -> None:
    """The arm from the side at four times, the path of the hand, and the arm where it is nearest to the obstacle."""
    recording, arm, obstacle = movement.recording, movement.task.arm, movement.task.obstacle
    view = SideView(arm, obstacle)
    end = int(np.searchsorted(recording.t, movement.end - 1e-9))
    for k in np.unique(np.linspace(0, end, 4).round().astype(int)):
        shade = 0.3 + 0.6 * k / max(end, 1)
        stick = view.stick(recording.q[k])
        panel.plot(*stick.T, "-", color=ARM_COLOR, alpha=shade, linewidth=2.5, solid_capstyle="round", zorder=2)
        panel.plot(*stick[:-1].T, "o", color=ARM_COLOR, alpha=shade, markersize=5, zorder=2)
    panel.plot(*_projected(view, recording.p_WH), color=HAND_COLOR, linewidth=2.5, zorder=4)
    _title(panel, "the arm (m)")
    if obstacle is not None and arm.outline:
        clearance = Clearance(MakeTorqueArm(arm), arm, obstacle)
        nearest = min(range(len(recording.t)), key=lambda k: clearance(recording.q[k])[0].min())
        for a, b, radius in view.outline(recording.q[nearest]):
            panel.fill(*capsule_edge(a, b, radius).T, color=NEAREST_COLOR, alpha=0.35, linewidth=0, zorder=2.5)
        panel.set_xlabel(f"nearest to the obstacle at {recording.t[nearest]:.2f} s", fontsize=FONT, color=NEAREST_COLOR)
    _draw_obstacle(panel, view, movement)
    _finish_view(panel)


def _draw_hand_path(panel: Axes, movement: Movement) -> None:
    """The paths of the hand in all runs, and a circle around the end of the reference."""
    view = SideView(movement.task.arm, movement.task.obstacle)
    for run in movement.noisy:
        panel.plot(*_projected(view, run.p_WH), color=HAND_COLOR, alpha=0.45, linewidth=0.9, zorder=2)
    panel.plot(*_projected(view, movement.recording.p_WH), color=HAND_COLOR, linewidth=2.5, zorder=3)
    reference = _projected(view, _reference_hand(movement)[0])
    panel.plot(*reference, color="black", **_REFERENCE)
    panel.add_patch(Circle(tuple(reference[:, -1]), _NEAR_GOAL, fill=False, color=GOOD_COLOR, linewidth=1.5, zorder=5))
    limits = panel.dataLim.frozen()
    _draw_obstacle(panel, view, movement)
    panel.dataLim.set(limits)
    _title(panel, "path of the hand (m)")
    panel.set_xlabel("circle: 1 cm around the goal", fontsize=FONT, color=GOOD_COLOR)
    _finish_view(panel)


def _draw_obstacle(panel: Axes, view: SideView, movement: Movement) -> None:
    obstacle = movement.task.obstacle
    if obstacle is not None:
        x, y = view.project(np.array(obstacle.position))
        panel.add_patch(Circle((x, y), obstacle.radius, color=OBSTACLE_COLOR, linewidth=0, zorder=3))


def _projected(view: SideView, points: np.ndarray) -> np.ndarray:
    """Points (N, 3) of the world in a picture (2, N)."""
    return np.transpose([view.project(point) for point in points])


def _reference_hand(movement: Movement) -> tuple[np.ndarray, np.ndarray]:
    """Where the reference has the tip of the hand, and its velocity, (N, 3) each."""
    arm, recording = movement.task.arm, movement.recording
    return hand_motion(MakeTorqueArm(arm), arm, recording.reference_q, recording.reference_v)


def _finish_view(panel: Axes) -> None:
    panel.margins(0.1)
    panel.set_aspect("equal", adjustable="datalim")
    finish_panel(panel)


def _title(panel: Axes, title: str) -> None:
    panel.set_title(title, loc="left", fontsize=FONT + 1, fontweight="bold")


def _legend_above(panel: Axes, handles: Sequence[Any]) -> None:
    """A legend beside the title of a panel, where it covers nothing."""
    panel.legend(
        handles=handles, loc="lower right", bbox_to_anchor=(1.01, 0.98), ncols=len(handles), fontsize=FONT - 1,
        frameon=False, borderpad=0.2, handlelength=2.6, columnspacing=1.2,
    )  # fmt: skip


def _head(figure: Figure, movement: Movement) -> None:
    """Which movement it is, whether it succeeded, how exact it was, and what the lines mean."""
    found, share = movement.metrics["noise_free"], movement.metrics["success_rate"]
    verdict = ", ".join(
        f"{name.replace('_', ' ')} {'yes' if met else 'NO'}"
        + (f" ({share[name]:.0%} with noise)" if movement.noisy else "")
        for name, met in found["success"].items()
    )
    good = all(found["success"].values()) and (not movement.noisy or min(share.values(), default=1.0) == 1.0)
    errors = zip(movement.metrics["joints"], found["tracking_error_mean"], found["end_error"], strict=True)
    clearance = f" Clearance {found['clearance_cm']:.2g} cm." if "clearance_cm" in found else ""
    load = f" Load {movement.task.load_mass:g} kg." if movement.task.load_mass else ""
    facts = (
        "Mean and end error: " + ", ".join(f"{name} {mean:.2g} and {end:.2g} rad" for name, mean, end in errors)
        + f". The hand ends {found['hand_end_error_cm']:.2g} cm from its goal, at {found['hand_end_speed']:.2g} m/s.\n"
        f"Metabolic energy {found['metabolic_energy']:.3g} J, squared activations {found['squared_activation']:.2g} s."
        f"{clearance}{load}"
    )  # fmt: skip
    figure.text(0.02, 0.987, movement.title, fontsize=18, fontweight="bold", va="top")
    figure.text(0.02, 0.956, movement.description, fontsize=FONT + 1, va="top")
    color = GOOD_COLOR if good else BAD_COLOR
    figure.text(0.02, 0.937, f"Success: {verdict}", fontsize=FONT + 1, va="top", color=color, fontweight="bold")
    figure.text(0.02, 0.918, facts, fontsize=FONT, va="top", color=NOTE_COLOR, linespacing=1.35)
    handles: list[Any] = [
        Line2D([], [], color=joint_color(j), linestyle=_DASHES[j % len(_DASHES)], linewidth=2.0, label=name)
        for j, name in enumerate(movement.task.arm.coordinates)
    ]
    handles.append(Line2D([], [], label="reference", color="black", **_REFERENCE))
    if movement.noisy:
        handles.append(Patch(color=NOTE_COLOR, alpha=_SPREAD, label=f"range of {len(movement.noisy)} runs with noise"))
    figure.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.06, 0.857), ncols=len(handles), fontsize=FONT,
        frameon=False, borderpad=0.0, handlelength=2.6, columnspacing=1.4,
    )  # fmt: skip
