"""How the hand moves in a recording."""

from dataclasses import dataclass

import numpy as np

from drakearm.model import MakeTorqueArm
from drakearm.model.points import point_positions, read_points
from drakearm.model.recording import Recording
from drakearm.task import TrackingTask


@dataclass(frozen=True)
class HandMotion:
    """The motion of the tip of the hand at times t (N,), in the world."""

    t: np.ndarray  # s
    p: np.ndarray  # (N, 3), m
    desired: np.ndarray  # (N, 3), m, where the reference has the tip
    speed: np.ndarray  # (N,), m/s

    @property
    def end_error(self) -> float:
        """m, from the end of the reference."""
        return float(np.linalg.norm(self.p[-1] - self.desired[-1]))

    @property
    def amplitude(self) -> float:
        """m, from the start to the end of the reference."""
        return float(np.linalg.norm(self.desired[-1] - self.desired[0]))


def hand_motion(task: TrackingTask, recording: Recording) -> HandMotion:
    """The motion of the hand in a recording of a task."""
    tip = read_points(MakeTorqueArm(task.arm), [(task.arm.tip_frame, (0.0, 0.0, 0.0))])
    position, jacobian = zip(*(point_positions(q, tip) for q in recording.q), strict=True)
    v = np.einsum("kcj,kj->kc", np.array(jacobian)[:, 0], recording.v)
    desired = np.array([point_positions(q, tip)[0][0] for q in recording.reference_q])
    return HandMotion(recording.t, np.array(position)[:, 0], desired, np.linalg.norm(v, axis=1))
