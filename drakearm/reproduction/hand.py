"""Where a task's reference has the hand."""

import numpy as np

from drakearm.model import MakeTorqueArm
from drakearm.model.skeleton import hand_motion
from drakearm.task import TrackingTask


def desired_path(task: TrackingTask) -> np.ndarray:
    """p_WH (N, 3), m, of the tip of the hand in the world, along the reference."""
    return hand_motion(MakeTorqueArm(task.arm), task.arm, task.reference.q, task.reference.v)[0]
