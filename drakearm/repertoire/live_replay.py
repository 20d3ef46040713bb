"""A movement live in Meshcat: the closed loop runs again for each press of play, and for another load or target."""

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from drakearm.diagrams import MakeSimulator
from drakearm.diagrams.muscle_arm import TIME_STEP
from drakearm.errors import PlanningError
from drakearm.model import MakeTorqueArm
from drakearm.model.skeleton import hand_motion
from drakearm.repertoire.driver import STATIC, Driver, find_driver
from drakearm.repertoire.live_page import FRAME, STOP, LivePage, Slider
from drakearm.repertoire.planned import PlannedMovement

PLAY, REPERTOIRE = "play", "reaching"
X, Y, LOAD, SPEED = "target x (m)", "target y (m)", "load (kg)", "speed (%)"
_AROUND = 0.4  # m, how far from the target of the movement another one can be
_STILL = 0.4  # s, after which a slider that was moved counts


class _Asked(NamedTuple):
    """What the sliders ask for."""

    x: float  # m, of the target
    y: float
    load_mass: float  # kg


class LiveReplay(LivePage):
    """The page of one movement.

    What is changed is planned anew. A policy that has learned one movement cannot make it then, so the policy of the
    shipped repertoire does; for another arm than its own, static optimization. The page says what drives the muscles.
    """

    def __init__(self, planned: PlannedMovement, driver: Driver, port: int | None = None):
        """port: of the page, on this computer only; by default the first free one from 7000."""
        self._own = planned, driver
        target, load_mass = self._target_of(planned), planned.task.load_mass
        sliders: dict[str, Slider] = {
            name: (round(at - _AROUND, 2), round(at + _AROUND, 2), 0.01, float(at))
            for name, at in zip((X, Y), target[:2], strict=True)
        }
        sliders[LOAD] = (0.0, max(2.0, 2.0 * load_mass), 0.1, load_mass)
        sliders[SPEED] = (5.0, 100.0, 5.0, 25.0)
        super().__init__(sliders, (PLAY,), port)
        self._unchanged = self._shown = self._moved = self._asked()
        self._moved_at = time.monotonic()
        self._clock = 0.0  # s of the movement; the simulation follows in whole time steps
        self._make(planned, driver)

    @property
    def time(self) -> float:
        """s of the movement, from its start."""
        return float(self._simulator.get_context().get_time())

    @property
    def end(self) -> float:
        """s of the movement, when it is over."""
        return self._loop.systems.task.reference.duration

    @property
    def arm_state(self) -> np.ndarray:
        """q and v of the joints, (2 n_q,), rad and rad/s."""
        plant = self._loop.systems.arm.plant
        state: np.ndarray = plant.GetPositionsAndVelocities(plant.GetMyContextFromRoot(self._simulator.get_context()))
        return state

    def Step(self, say: Callable[[str], object] = print) -> bool:
        """Obeys the controls and simulates a frame, up to the end of the movement. Returns whether to go on.

        say: gets a sentence for each target or load that is refused.
        """
        play = self._clicked(PLAY)  # before the sliders, so that what was set before the press counts
        asked, now = self._asked(), time.monotonic()
        if asked != self._moved:
            self._moved, self._moved_at = asked, now
        if play or (asked != self._shown and now - self._moved_at > _STILL):
            if asked != self._shown:
                self._change(asked, say)
            self._begin()
        speed = 0.01 * self.meshcat.GetSliderValue(SPEED)
        self._clock = min(self._clock + speed * FRAME, self.end)
        # Whole time steps, so that the movement is the same at every speed.
        self._simulator.AdvanceTo(self.end if self._clock == self.end else TIME_STEP * round(self._clock / TIME_STEP))
        return not self._clicked(STOP)

    def _asked(self) -> _Asked:
        x, y, load_mass, _ = self._values()
        return _Asked(x, y, load_mass)

    def _change(self, asked: _Asked, say: Callable[[str], object]) -> None:
        """Plans what is asked and makes its loop; if that is impossible, the movement stays as it was."""
        self._shown = asked
        planned, driver = self._own
        if asked != self._unchanged:
            place = None if asked[:2] == self._unchanged[:2] else (asked.x, asked.y)
            try:
                planned = planned.changed(place, asked.load_mass)
            except PlanningError as error:
                depth = self._target_of(planned)[2]
                self._show_target(planned.task.arm, np.array([asked.x, asked.y, depth]), accepted=False)
                self._write(str(error))
                say(str(error))
                return
            if not driver.makes_all_movements:
                driver = find_driver(REPERTOIRE)
                if not driver.fits(planned):
                    driver = find_driver(STATIC)
        self._make(planned, driver)

    def _make(self, planned: PlannedMovement, driver: Driver) -> None:
        """Makes the loop of a movement, and shows where it goes."""
        self._loop = driver.loop(planned, self.meshcat)
        self._simulator = MakeSimulator(self._loop.diagram)
        self._show_target(planned.task.arm, self._target_of(planned), accepted=True)
        self._write(f"driven by: {driver.name}")
        self._begin()

    def _begin(self) -> None:
        """Sets the arm to the start of the movement."""
        self._loop.systems.Reset(self._simulator.get_mutable_context())
        self._simulator.Initialize()
        self._clock = self.time
        self._start_clock()

    @staticmethod
    def _target_of(planned: PlannedMovement) -> np.ndarray:
        """Where the hand is at the end of the plan, (3,), m."""
        arm, reference = planned.task.arm, planned.task.reference
        p_WH, _ = hand_motion(MakeTorqueArm(arm), arm, reference.q[-1:], reference.v[-1:])
        return p_WH[0]
