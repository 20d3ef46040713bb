"""An arm projected onto a plane: along the obstacle's axis if there is one, else along the axis of the first joint."""

import numpy as np

from drakearm.model import Arm, MakeTorqueArm
from drakearm.model.obstacle import Obstacle

_ARC = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 24)  # rad
Capsule2d = tuple[np.ndarray, np.ndarray, float]  # ends (2,) of a line and the radius of what surrounds it, m


class SideView:
    """Where the parts of an arm are in a picture, in m to the right and up, seen from the positive end of the axis."""

    def __init__(self, arm: Arm, obstacle: Obstacle | None = None):
        self._arm = arm
        self._obstacle = obstacle
        self._plant = MakeTorqueArm(arm)
        self._context = self._plant.CreateDefaultContext()
        self._axes = self._right_and_up()

    def _right_and_up(self) -> np.ndarray:
        """The directions (2, 3) of the picture in the world."""
        if self._obstacle is not None:
            toward = self._obstacle.direction
        else:  # the axis of the world that is closest to the axis of the first joint
            joint = self._plant.GetJointByName(self._arm.coordinates[0])
            axis = joint.frame_on_parent().CalcPoseInWorld(self._context).rotation().multiply(joint.revolute_axis())
            toward = np.eye(3)[np.abs(axis).argmax()]
        toward = toward * np.sign(toward[np.abs(toward).argmax()])
        up = -np.array(self._arm.gravity)
        up = up - (up @ toward) * toward
        if np.linalg.norm(up) < 1e-6:  # no gravity in the picture
            up = np.cross(toward, np.eye(3)[np.abs(toward).argmin()])
        up /= np.linalg.norm(up)
        return np.array([np.cross(up, toward), up])

    @property
    def labels(self) -> tuple[str, str]:
        """What the axes of the picture show: axes of the world, or directions if the picture is not along them."""
        return _axis_label(self._axes[0], "to the right (m)"), _axis_label(self._axes[1], "up (m)")

    def project(self, point: np.ndarray) -> np.ndarray:
        """A point (3,) of the world in the picture (2,)."""
        return self._axes @ point

    def stick(self, q: np.ndarray) -> np.ndarray:
        """The positions (n_q + 1, 2) of the joints and of the tip of the hand at joint angles q (n_q,), rad."""
        self._plant.SetPositions(self._context, q)
        frames = [self._plant.GetJointByName(name).frame_on_child() for name in self._arm.coordinates]
        frames.append(self._plant.GetFrameByName(self._arm.tip_frame))
        return np.array([self.project(frame.CalcPoseInWorld(self._context).translation()) for frame in frames])

    def outline(self, q: np.ndarray) -> list[Capsule2d]:
        """The capsules of the arm that an obstacle can touch, at joint angles q (n_q,), rad."""
        self._plant.SetPositions(self._context, q)

        def place(end: tuple) -> np.ndarray:
            body, p_BP = end
            return self.project(
                self._plant.GetFrameByName(body).CalcPoseInWorld(self._context).multiply(np.array(p_BP))
            )

        return [(place(part.ends[0]), place(part.ends[1]), part.radius) for part in self._arm.outline]


def _axis_label(direction: np.ndarray, otherwise: str) -> str:
    along = int(np.abs(direction).argmax())
    if not np.isclose(abs(direction[along]), 1.0):
        return otherwise
    return f"{'-' if direction[along] < 0.0 else ''}{'xyz'[along]} (m)"


def capsule_edge(a: np.ndarray, b: np.ndarray, radius: float) -> np.ndarray:
    """The edge (N, 2) of everything within a radius of the line from a to b."""
    along = np.arctan2(*(b - a)[::-1])
    arcs = [(b, along + _ARC), (a, along + np.pi + _ARC)]
    return np.vstack([end + radius * np.column_stack([np.cos(turn), np.sin(turn)]) for end, turn in arcs])
