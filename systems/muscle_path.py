"""The path on which a muscle is drawn: smooth, outside of the joints, and as long as its path function says."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import scipy
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model import Arm
from drakearm.model.arm import Muscle
from drakearm.model.musculature import muscle_geometry

_SAMPLES = 40  # of a path, from which its pieces are cut
# From the straight path at -1 to the smooth one at 0 and the one with the widest arcs at 1. Between these, lengths are
# nearly proportional to the share.
_SHARES = np.array([-1.0, -0.75, -0.5, -0.25, 0.0, 0.01, 0.03, 0.06, 0.1, 0.2, 0.4, 0.7, 1.0])
_WIDEST = 0.4  # height of an arc over its joint, over the distance of the two points beside the joint


def smooth_path(points: np.ndarray) -> np.ndarray:
    """Samples (K, 3) of a smooth curve through points (m, 3), m, in their order: a Catmull-Rom spline."""
    return smoothing(points)[0] @ points


def smoothing(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Matrices (K, m) from points (m, 3), m, to samples of the smooth curve through them, and of the straight lines.

    Also between which points each sample is, (K,): 1.5 is in the middle of the second and the third one. The matrices
    depend on the distances of the points only, so they may be kept while these change little.
    """
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    own = np.flatnonzero(np.append(True, steps > 0.0))  # points that coincide with the one before are left out
    every = np.eye(len(points))
    if len(own) < 2:
        return every[[0, -1]], every[[0, -1]], np.array([0.0, len(points) - 1.0])
    at = np.append(0.0, np.cumsum(steps[steps > 0.0]))
    chosen = every[own]
    samples = np.union1d(at, np.linspace(0.0, at[-1], _SAMPLES))
    straight = np.stack([np.interp(samples, at, column) for column in chosen.T], axis=1)
    place = np.interp(samples, at, own)
    if len(own) == 2:
        return straight, straight, place
    return scipy.interpolate.CubicHermiteSpline(at, chosen, np.gradient(chosen, at, axis=0))(samples), straight, place


class MusclePaths:
    """The drawn paths of an arm's muscles. `__call__` gives them for the poses of the bodies.

    A path goes through the muscle's points and has the length of the path function, as far as possible. Where a smooth
    curve is too long, it is drawn straighter. Where it is too short, it makes an arc around each joint that the muscle
    crosses, on the side on which the muscle pulls.
    """

    def __init__(self, plant: MultibodyPlant, arm: Arm):
        """plant: a finalized plant with the arm's skeleton."""
        self._arm = arm
        self._joints = [_Joint(plant, name) for name in arm.coordinates]
        poses = plant.get_body_poses_output_port().Eval(plant.CreateDefaultContext())
        low, high = np.array([(joint.low, joint.high) for joint in self._joints]).T
        paths = []
        for i, muscle in enumerate(arm.muscles):
            sides = []
            for j in range(len(low)):  # the mean moment arm over the range of the joint
                there, back = (np.where(np.arange(len(low)) == j, end, 0.0) for end in (low, high))
                sides.append(np.sign(self._lengths(there)[i] - self._lengths(back)[i]))
            paths.append(_Path(plant, muscle, self._joints, sides, poses))
        self._paths = paths

    def __call__(self, X_WB: Sequence[RigidTransform]) -> list[np.ndarray]:
        """Samples (K, 3) of each muscle's path in the world, m. X_WB: in the order of BodyIndex."""
        lengths = self._lengths(np.array([joint.angle(X_WB) for joint in self._joints]))
        axes = [joint.axis(X_WB) for joint in self._joints]
        return [path.of_length(length, X_WB, axes) for path, length in zip(self._paths, lengths.tolist(), strict=True)]

    def _lengths(self, q: np.ndarray) -> np.ndarray:
        return muscle_geometry(q, self._arm.muscle_table, self._arm.path_table)[0]


class _Path:
    """One muscle's path."""

    def __init__(
        self,
        plant: MultibodyPlant,
        muscle: Muscle,
        joints: "Sequence[_Joint]",
        sides: Sequence[float],
        X_WB: Sequence[RigidTransform],
    ):
        """sides: 1 or -1 for each joint: whether the muscle pulls towards larger or smaller angles."""
        self._bodies = [int(plant.GetBodyByName(body).index()) for body, _ in muscle.points]
        self._points = [np.array(point) for _, point in muscle.points]
        self._smooth, self._straight, place = smoothing(self._in_world(X_WB))
        self._arcs = []  # a joint, the point before it, and the shape of the arc over it
        for j, (joint, side) in enumerate(zip(joints, sides, strict=True)):
            for i, (before, after) in enumerate(pairwise(self._bodies)):
                if (before in joint.moved) != (after in joint.moved):
                    out = side if after in joint.moved else -side
                    self._arcs.append((j, i, out * np.sin(np.pi * np.clip(place - i, 0.0, 1.0))))

    def of_length(self, length: float, X_WB: Sequence[RigidTransform], axes: Sequence[np.ndarray]) -> np.ndarray:
        """length: m. axes: of the joints, in the world."""
        points = self._in_world(X_WB)
        smooth, straight, arc = self._smooth @ points, self._straight @ points, np.zeros((len(self._smooth), 3))
        for j, i, height in self._arcs:
            chord = points[i + 1] - points[i]
            aside = np.cross(axes[j], chord)
            size = np.linalg.norm(aside)
            if size > 0.0:
                arc += np.outer(_WIDEST * np.linalg.norm(chord) * height, aside / size)

        def mixed(share: np.ndarray) -> np.ndarray:
            smoothly, widely = np.sqrt(np.clip(share + 1.0, 0.0, 1.0)), np.sqrt(np.clip(share, 0.0, 1.0))
            return straight + smoothly[:, None, None] * (smooth - straight) + widely[:, None, None] * arc

        lengths = np.linalg.norm(np.diff(mixed(_SHARES), axis=1), axis=2).sum(axis=1)
        share = np.interp(length, np.maximum.accumulate(lengths), _SHARES)
        return mixed(np.array([share]))[0]

    def _in_world(self, X_WB: Sequence[RigidTransform]) -> np.ndarray:
        return np.array([X_WB[body].multiply(p) for body, p in zip(self._bodies, self._points, strict=True)])


class _Joint:
    """The angle (rad) and the axis of a joint, from the poses of the bodies."""

    def __init__(self, plant: MultibodyPlant, name: str):
        joint = plant.GetJointByName(name)
        self.moved = {int(body) for body in plant.GetBodiesKinematicallyAffectedBy([joint.index()])}
        low, high = float(joint.position_lower_limits()[0]), float(joint.position_upper_limits()[0])
        limited = bool(np.isfinite([low, high]).all())
        self.low = low if limited else -np.pi
        self.high = high if limited else np.pi
        self._parent, self._child = int(joint.parent_body().index()), int(joint.child_body().index())
        self._R_PF = joint.frame_on_parent().GetFixedPoseInBodyFrame().rotation()
        self._R_CM = joint.frame_on_child().GetFixedPoseInBodyFrame().rotation()
        self._axis = joint.revolute_axis()

    def angle(self, X_WB: Sequence[RigidTransform]) -> float:
        """The angle that is within half a turn of the middle of the joint's range."""
        R_WF, R_WM = X_WB[self._parent].rotation() @ self._R_PF, X_WB[self._child].rotation() @ self._R_CM
        turn = (R_WF.inverse() @ R_WM).ToAngleAxis()
        angle, middle = turn.angle() * np.sign(turn.axis() @ self._axis), 0.5 * (self.low + self.high)
        return float(middle + (angle - middle + np.pi) % (2.0 * np.pi) - np.pi)

    def axis(self, X_WB: Sequence[RigidTransform]) -> np.ndarray:
        """In the world."""
        axis: np.ndarray = (X_WB[self._parent].rotation() @ self._R_PF).multiply(self._axis)
        return axis
