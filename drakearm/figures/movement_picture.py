"""A picture of a movement: what the arm, its hand and its muscles did in a run, and in the runs with noise."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from scipy.integrate import cumulative_trapezoid

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
    HAND_SPEED,
    HEADING,
    LINE,
    METABOLIC,
    NEAREST,
    NEAREST_NAME,
    NOTE_COLOR,
    OBSTACLE,
    OBSTACLE_NAME,
    REFERENCE,
    REFERENCE_NAME,
    SMALL,
    SPEED,
    SPREAD,
    WORK,
    Look,
    finish_panel,
    finish_times,
    joint_line,
    legend_above,
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
_DARK = 0.4  # brightness of the reference's color over that of the line which follows it
_LEFT, _RIGHT, _TOP = 0.065, 0.585, 0.82  # of the figure


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
    left = figure.add_gridspec(4, 1, left=_LEFT, right=0.485, top=_TOP, bottom=0.05, hspace=0.24)
    right = figure.add_gridspec(
        3, 1, left=_RIGHT, right=0.965, top=_TOP, bottom=0.05, hspace=0.42, height_ratios=(1.15, 1.3, 0.75)
    )
    views = right[0].subgridspec(1, 2, wspace=0.32)
    rows = [figure.add_subplot(left[i]) for i in range(4)]
    energy = figure.add_subplot(right[2])
    _draw_angles(rows[0], movement)
    _draw_errors(rows[1], movement)
    _draw_torques(rows[2], movement)
    _draw_hand_speed(rows[3], movement)
    _draw_energy(energy, movement)
    figure.align_ylabels(rows)
    for panels in (rows, [energy]):
        finish_times(panels, movement.end, float(movement.recording.t[-1]))
    shown = _draw_arm(figure.add_subplot(views[0]), movement)
    shown += _draw_hand_path(figure.add_subplot(views[1]), movement)
    legend_above(figure, shown, _RIGHT, 0.85, columns=2)
    _draw_activations(figure, right[1], movement)
    _head(figure, movement)
    return figure


def _draw_angles(panel: Axes, movement: Movement) -> None:
    _by_joint(panel, movement, lambda run: np.rad2deg(run.q))
    _references(panel, movement, np.rad2deg(movement.recording.reference_q))
    finish_panel(panel, "joint angles", y=ANGLE)


def _draw_errors(panel: Axes, movement: Movement) -> None:
    _by_joint(panel, movement, lambda run: run.q - run.reference_q)
    finish_panel(panel, "tracking errors: angle minus reference", y="error (rad)")


def _draw_torques(panel: Axes, movement: Movement) -> None:
    _by_joint(panel, movement, lambda run: run.muscle_torque)
    _references(panel, movement, movement.task.reference.tau[-len(movement.recording.t) :])
    finish_panel(panel, "torques of the muscles on the joints", y="torque (Nm)")


def _draw_hand_speed(panel: Axes, movement: Movement) -> None:
    _line_and_spread(panel, movement, lambda run: run.hand_speed, color=HAND_COLOR)
    speed = np.linalg.norm(_reference_hand(movement)[1], axis=1)
    panel.plot(movement.recording.t, speed, zorder=3, **REFERENCE)
    finish_panel(panel, HAND_SPEED, y=SPEED)


def _draw_energy(panel: Axes, movement: Movement) -> None:
    """Energy that was used and work that was done up to each time."""

    def integral(power: np.ndarray, run: Recording) -> np.ndarray:
        return cumulative_trapezoid(power.sum(axis=1), run.t, initial=0.0)

    used = _line_and_spread(panel, movement, lambda run: integral(run.metabolic_power, run), **METABOLIC)
    used.set_label("metabolic")
    done = _line_and_spread(panel, movement, lambda run: integral(run.fiber_power + run.tendon_power, run), **WORK)
    done.set_label("work on the joints")
    finish_panel(panel, "energy of the muscles", y="energy (J)")
    legend_above(panel, [used, done], 0.45, 1.04)


def _draw_activations(figure: Figure, place: SubplotSpec, movement: Movement) -> None:
    """The raster, the roles of the muscles and the bar that explains the colors, all within a place of the figure."""
    raster, bar = raster_places(place)
    panel = figure.add_subplot(raster)
    arm, recording = movement.task.arm, movement.recording
    roles = muscle_roles(arm)
    image = draw_raster(panel, recording.t, recording.activation, arm, roles)
    label_roles(panel, roles)
    panel.set_title("activations", loc="left", fontsize=FONT + 1, fontweight="bold")
    panel.annotate(
        ROLES, (0.0, -0.19), xycoords="axes fraction", fontsize=SMALL, color=NOTE_COLOR, annotation_clip=False
    )
    activation_bar(figure, image, bar.get_position(figure).bounds)


def _by_joint(panel: Axes, movement: Movement, quantity: Any) -> None:
    """One line per joint with its spread. quantity: of a recording, (N, n_q)."""
    for j in range(len(movement.task.arm.coordinates)):
        _line_and_spread(panel, movement, lambda run, j=j: quantity(run)[:, j], **joint_line(j))


def _references(panel: Axes, movement: Movement, samples: np.ndarray) -> None:
    """One dotted line per joint, in a dark tone of its color. samples: (N, n_q)."""
    for j in range(samples.shape[1]):
        color = tuple(_DARK * np.array(to_rgb(joint_line(j)["color"])))
        panel.plot(movement.recording.t, samples[:, j], zorder=3, **REFERENCE | {"color": color})


def _line_and_spread(panel: Axes, movement: Movement, quantity: Any, **style: Any) -> Line2D:
    """A line of the run without noise, and the range of the runs with noise. quantity: of a recording, (N,)."""
    t = movement.recording.t
    if movement.noisy:
        runs = np.array([quantity(run) for run in movement.noisy])
        lowest, highest = runs.min(axis=0), runs.max(axis=0)
        panel.fill_between(t, lowest, highest, color=style["color"], alpha=SPREAD, linewidth=0, zorder=1.5)
    (line,) = panel.plot(t, quantity(movement.recording), linewidth=LINE, zorder=2, **style)
    return line


def _draw_arm(panel: Axes, movement: Movement) -> list[Artist]:
    """The arm from the side at four times, the path of the hand, and the arm where it is nearest to the obstacle.

    Returns what a legend explains.
    """
    recording, arm, obstacle = movement.recording, movement.task.arm, movement.task.obstacle
    view = SideView(arm, obstacle)
    end = int(np.searchsorted(recording.t, movement.end - 1e-9))
    for k in np.unique(np.linspace(0, end, 4).round().astype(int)):
        shade = 0.3 + 0.6 * k / max(end, 1)
        stick = view.stick(recording.q[k])
        panel.plot(*stick.T, "-", color=ARM_COLOR, alpha=shade, linewidth=2.5, solid_capstyle="round", zorder=2)
        panel.plot(*stick[:-1].T, "o", color=ARM_COLOR, alpha=shade, markersize=5, zorder=2)
    shown: list[Artist] = [
        *panel.plot(*_projected(view, recording.p_WH), color=HAND_COLOR, linewidth=2.5, zorder=4, label=HAND_PATH)
    ]
    if obstacle is not None and arm.outline:
        clearance = Clearance(MakeTorqueArm(arm), arm, obstacle)
        nearest = int(np.argmin([clearance(q)[0].min() for q in recording.q]))
        for a, b, radius in view.outline(recording.q[nearest]):
            panel.fill(*capsule_edge(a, b, radius).T, zorder=2.5, **NEAREST)
        shown.append(Patch(label=f"{NEAREST_NAME} {recording.t[nearest]:.2f} s", **NEAREST))
    if obstacle is not None:
        shown.append(Patch(label=OBSTACLE_NAME, **OBSTACLE))
    _draw_obstacle(panel, view, movement)
    _finish_view(panel, "the arm from the side", view)
    return shown


def _draw_hand_path(panel: Axes, movement: Movement) -> list[Artist]:
    """The paths of the hand in all runs, and a circle around the end of the reference, which a legend explains."""
    view = SideView(movement.task.arm, movement.task.obstacle)
    for run in movement.noisy:
        panel.plot(*_projected(view, run.p_WH), color=HAND_COLOR, alpha=0.45, linewidth=0.9, zorder=2)
    panel.plot(*_projected(view, movement.recording.p_WH), color=HAND_COLOR, linewidth=2.5, zorder=3)
    reference = _projected(view, _reference_hand(movement)[0])
    panel.plot(*reference, zorder=3, **REFERENCE)
    panel.add_patch(Circle(tuple(reference[:, -1]), _NEAR_GOAL, fill=False, color=GOOD_COLOR, linewidth=1.5, zorder=5))
    limits = panel.dataLim.frozen()
    _draw_obstacle(panel, view, movement)
    panel.dataLim.set(limits)
    _finish_view(panel, HAND_PATH, view)
    circle: Look = {"marker": "o", "markersize": 9, "fillstyle": "none", "color": GOOD_COLOR, "linestyle": ""}
    return [Line2D([], [], label=f"{100 * _NEAR_GOAL:g} cm around its goal", **circle)]


def _draw_obstacle(panel: Axes, view: SideView, movement: Movement) -> None:
    obstacle = movement.task.obstacle
    if obstacle is not None:
        x, y = view.project(np.array(obstacle.position))
        panel.add_patch(Circle((x, y), obstacle.radius, zorder=3, **OBSTACLE))


def _projected(view: SideView, points: np.ndarray) -> np.ndarray:
    """Points (N, 3) of the world in a picture (2, N)."""
    return np.transpose([view.project(point) for point in points])


def _reference_hand(movement: Movement) -> tuple[np.ndarray, np.ndarray]:
    """Where the reference has the tip of the hand, and its velocity, (N, 3) each."""
    arm, recording = movement.task.arm, movement.recording
    return hand_motion(MakeTorqueArm(arm), arm, recording.reference_q, recording.reference_v)


def _finish_view(panel: Axes, title: str, view: SideView) -> None:
    panel.margins(0.1)
    panel.set_aspect("equal", adjustable="datalim")
    finish_panel(panel, title, *view.labels)


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
    clearance = f" Clearance {found['clearance_cm']:z.2g} cm." if "clearance_cm" in found else ""
    load = f" Load {movement.task.load_mass:g} kg." if movement.task.load_mass else ""
    facts = (
        "Mean and end error: " + ", ".join(f"{name} {mean:.2g} and {end:.2g} rad" for name, mean, end in errors)
        + f". The hand ends {found['hand_end_error_cm']:.2g} cm from its goal, at {found['hand_end_speed']:.2g} m/s.\n"
        f"Metabolic energy {found['metabolic_energy']:.3g} J, squared activations {found['squared_activation']:.2g} s."
        f"{clearance}{load}"
    )  # fmt: skip
    figure.text(0.02, 0.987, movement.title, fontsize=HEADING, fontweight="bold", va="top")
    figure.text(0.02, 0.956, movement.description, fontsize=FONT + 1, va="top")
    color = GOOD_COLOR if good else BAD_COLOR
    figure.text(0.02, 0.937, f"Success: {verdict}", fontsize=FONT + 1, va="top", color=color, fontweight="bold")
    figure.text(0.02, 0.918, facts, fontsize=FONT, va="top", color=NOTE_COLOR, linespacing=1.35)
    handles: list[Any] = [
        Line2D([], [], linewidth=LINE, label=name, **joint_line(j))
        for j, name in enumerate(movement.task.arm.coordinates)
    ]
    handles.append(Line2D([], [], label=REFERENCE_NAME, **REFERENCE))
    if movement.noisy:
        label = f"range of {len(movement.noisy)} runs with noise"
        handles.append(Patch(color=NOTE_COLOR, alpha=SPREAD, linewidth=0, label=label))
    legend_above(figure, handles, _LEFT, 0.85)
