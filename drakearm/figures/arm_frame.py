"""A small picture of an arm at one time, as an array: a frame of a film."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from drakearm.figures.side_view import SideView
from drakearm.figures.style import ARM_COLOR, OBSTACLE_COLOR
from drakearm.model import Arm, MakeTorqueArm
from drakearm.model.obstacle import Obstacle
from drakearm.systems.muscle_drawing import activation_color
from drakearm.systems.muscle_path import smooth_path

SIZE = (480, 480)  # pixels
_DPI = 100
_WIDTH = 0.16  # points / sqrt(N): of a muscle's line over the square root of its max_isometric_force
_REFERENCE = "#009480"


class ArmFrame:
    """Draws an arm from the side: bones, muscles colored by activation, and the reference as a pale line."""

    def __init__(self, arm: Arm, obstacle: Obstacle | None = None):
        self._arm, self._view = arm, SideView(arm, obstacle)
        self._plant = MakeTorqueArm(arm)
        self._context = self._plant.CreateDefaultContext()
        self._bodies = [[self._plant.GetBodyByName(body) for body, _ in muscle.points] for muscle in arm.muscles]
        self._points = [[np.array(point) for _, point in muscle.points] for muscle in arm.muscles]
        figure = Figure(figsize=(SIZE[0] / _DPI, SIZE[1] / _DPI), dpi=_DPI)
        self._canvas = FigureCanvasAgg(figure)
        panel = figure.add_axes((0.0, 0.0, 1.0, 1.0), aspect="equal")
        panel.set_axis_off()
        (self._reference,) = panel.plot([], [], color=_REFERENCE, alpha=0.35, linewidth=9, solid_capstyle="round")
        (self._bones,) = panel.plot([], [], color=ARM_COLOR, alpha=0.25, linewidth=7, solid_capstyle="round")
        self._muscles = [
            panel.plot([], [], linewidth=_WIDTH * np.sqrt(muscle.max_isometric_force), solid_capstyle="round")[0]
            for muscle in arm.muscles
        ]
        straight = self._view.stick(np.zeros(len(arm.coordinates)))
        reach = 1.1 * float(np.linalg.norm(np.diff(straight, axis=0), axis=1).sum())
        x, y = straight[0]
        panel.set(xlim=(x - reach, x + reach), ylim=(y - reach, y + reach))
        if obstacle is not None:
            place = self._view.project(np.array(obstacle.position))
            panel.add_patch(Circle(tuple(place), obstacle.radius, color=OBSTACLE_COLOR, linewidth=0))

    def draw(self, q: np.ndarray, activation: np.ndarray, reference_q: np.ndarray) -> np.ndarray:
        """The picture (height, width, 3), uint8, at joint angles q (n_q,), rad, and activations (n,)."""
        self._reference.set_data(*self._view.stick(reference_q).T)
        self._bones.set_data(*self._view.stick(q).T)
        self._plant.SetPositions(self._context, q)
        colors = activation_color(np.asarray(activation))
        for line, bodies, points, color in zip(self._muscles, self._bodies, self._points, colors, strict=True):
            p_W = [body.EvalPoseInWorld(self._context).multiply(p) for body, p in zip(bodies, points, strict=True)]
            path = smooth_path(np.array(p_W))
            line.set_data(*np.array([self._view.project(point) for point in path]).T)
            line.set_color(tuple(color))
        self._canvas.draw()
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()
