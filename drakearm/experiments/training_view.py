"""The live view of a training: what the present policy does, in Meshcat, between the batches."""

import time
from collections.abc import Callable

import numpy as np

from drakearm.diagrams import MakePolicyLoop
from drakearm.learning import Policy
from drakearm.replay.replay import animate
from drakearm.replay.scene import ReplayScene
from drakearm.task import TrackingTask

LARGEST_SHARE = 0.04  # of the time since the view before, that a view takes


class TrainingView:
    """A page that repeats the movement of the latest policy that was shown.

    `show` runs a policy on the Diagram. To slow the training by little, it does so only when the last view was at most
    LARGEST_SHARE of the time since then. clock: gives the time, s.
    """

    def __init__(self, task: TrackingTask, clock: Callable[[], float] = time.perf_counter):
        self._task, self._clock = task, clock
        self._scene = ReplayScene(task.arm, task.load_mass, task.obstacle, port=None)
        views = self._scene.views(np.vstack([task.reference.q]))
        self._scene.set_camera(views["oblique"])
        self.url: str = self._scene.meshcat.web_url()
        self._next = -np.inf

    def show(self, load: Callable[[], Policy]) -> bool:
        """Shows a policy, which `load` gives, if enough time has passed. Returns whether it did."""
        began = self._clock()
        if began < self._next:
            return False
        animate(self._scene, MakePolicyLoop(self._task, load().act).Run())
        ended = self._clock()
        self._next = ended + (ended - began) / LARGEST_SHARE
        return True
