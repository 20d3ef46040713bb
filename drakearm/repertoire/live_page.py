"""A page of Meshcat with controls, a line of text, a target, and how far it lags behind its clock."""

import textwrap
import time
from collections.abc import Callable, Mapping

import numpy as np
from pydrake.geometry import Meshcat, MeshcatParams, Rgba, Sphere
from pydrake.math import RigidTransform

from drakearm.model import Arm
from drakearm.model.skeleton_file import LOAD
from drakearm.systems import upright
from drakearm.systems.skeleton_drawing import drawn_skeleton

FRAME = 0.03  # s, between two looks at the controls
STOP, LAG = "stop", "lag (ms)"
Slider = tuple[float, float, float, float]  # least, most, step, first value
_ACCEPTED, _REFUSED = Rgba(0.1, 0.6, 0.2, 0.8), Rgba(0.8, 0.1, 0.1, 0.8)
_TARGET, _TARGET_RADIUS = "/target", 0.012  # m
_LOAD = "/load"
_LINE = 32  # characters that fit into the panel


class LivePage:
    """Base of the pages that simulate. Each is only for this computer.

    `Step`, which a page overrides, obeys the controls and simulates one frame; `Run` does so until the stop button is
    pressed. meshcat: of the page. lag: s, by which the last frame was late.
    """

    def __init__(self, sliders: Mapping[str, Slider], buttons: tuple[str, ...], port: int | None = None):
        """port: by default the first free one from 7000."""
        self.meshcat = Meshcat(MeshcatParams(host="localhost", port=port, show_stats_plot=False))
        self._sliders = tuple(sliders)
        for name, (least, most, step, value) in sliders.items():
            self.meshcat.AddSlider(name, least, most, step, value)
        self.meshcat.AddSlider(LAG, 0.0, 1000.0, 1.0, 0.0)
        self._clicks = dict.fromkeys((*buttons, STOP), 0)
        for name in self._clicks:
            self.meshcat.AddButton(name)
        self._lines: list[str] = []  # of text
        self.lag = 0.0
        self._start_clock()

    def Step(self, say: Callable[[str], object] = print) -> bool:
        """Obeys the controls and simulates a frame. Returns whether the stop button has not been pressed.

        say: gets each sentence that a user should read.
        """
        raise NotImplementedError

    def Run(self, say: Callable[[str], object]) -> None:
        """Simulates at the pace of the clock until the stop button is pressed. say: see `Step`."""
        self._start_clock()
        while self.Step(say):
            self._due += FRAME
            ahead = self._due - time.monotonic()
            if ahead > 0.0:
                time.sleep(ahead)
            self.lag = max(0.0, -ahead)
            self.meshcat.SetSliderValue(LAG, round(1000.0 * self.lag))

    def _start_clock(self) -> None:
        """Forgets the lag: counts the time from now."""
        self._due = time.monotonic()

    def _values(self) -> tuple[float, ...]:
        """The values of the sliders, in their order."""
        return tuple(self.meshcat.GetSliderValue(name) for name in self._sliders)

    def _clicked(self, button: str) -> bool:
        """Whether a button has been pressed since the last call."""
        clicks = self.meshcat.GetButtonClicks(button)
        fresh, self._clicks[button] = clicks > self._clicks[button], clicks
        return fresh

    def _write(self, text: str) -> None:
        """Writes a text below the controls, in place of the one before. Each line is the name of a button."""
        lines = textwrap.wrap(text, _LINE)
        if lines == self._lines:
            return
        for line in self._lines:
            self.meshcat.DeleteButton(line, strict=False)
        for line in lines:
            self.meshcat.AddButton(line)
        self._lines = lines

    def _show_target(self, arm: Arm, p_WT: np.ndarray, accepted: bool) -> None:
        """A ball at a position (3,), m: green, or red if the target is refused."""
        self.meshcat.SetObject(_TARGET, Sphere(_TARGET_RADIUS), _ACCEPTED if accepted else _REFUSED)
        self.meshcat.SetTransform(_TARGET, upright(arm) @ RigidTransform(p_WT))

    def _draw_load(self, arm: Arm, mass: float) -> None:
        """Draws the shapes of a load of this mass (kg), in place of those before. `_move_load` moves them."""
        self.meshcat.Delete(_LOAD)
        if mass == 0.0:
            return
        plant, scene_graph = drawn_skeleton(arm, mass)
        inspector = scene_graph.model_inspector()
        for k, shape in enumerate(plant.GetVisualGeometriesForBody(plant.GetBodyByName(LOAD))):
            color = inspector.GetIllustrationProperties(shape).GetProperty("phong", "diffuse")
            self.meshcat.SetObject(f"{_LOAD}/{k}", inspector.GetShape(shape), color)
            self.meshcat.SetTransform(f"{_LOAD}/{k}", inspector.GetPoseInFrame(shape))

    def _move_load(self, arm: Arm, X_WL: RigidTransform) -> None:
        """X_WL: pose of the load."""
        self.meshcat.SetTransform(_LOAD, upright(arm) @ X_WL)
