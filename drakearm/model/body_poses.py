"""Poses of a skeleton's bodies at many joint angles at once, from the frames and axes of a MultibodyPlant's joints.

A plant computes one posture per call from Python. Path functions are fitted to a hundred thousand postures.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import scipy
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RevoluteJoint


class Poses(NamedTuple):
    """Poses X_WB of a body in the world, at N postures."""

    rotation: np.ndarray  # (N, 3, 3)
    position: np.ndarray  # (N, 3), m

    def place(self, p_BP: np.ndarray) -> np.ndarray:
        """The positions p_WP (N, 3) of a point of the body."""
        return self.rotation @ p_BP + self.position

    def locate(self, p_WP: np.ndarray) -> np.ndarray:
        """The positions p_BP (N, 3) of points p_WP (N, 3) in the body."""
        return np.einsum("nji,nj->ni", self.rotation, p_WP - self.position)

    def moved(self, X_BC: RigidTransform) -> "Poses":
        """The poses of a frame C that is fixed to the body."""
        return Poses(self.rotation @ X_BC.rotation().matrix(), self.place(X_BC.translation()))


def body_poses(plant: MultibodyPlant, bodies: Iterable[str], q: np.ndarray) -> dict[str, Poses]:
    """The poses of bodies, by name, at joint angles q (N, n_q), rad. plant: finalized, of revolute and fixed joints."""
    joints = [plant.get_joint(index) for index in plant.GetJointIndices()]
    inboard = {joint.child_body().index(): joint for joint in joints}
    still = Poses(np.tile(np.eye(3), (len(q), 1, 1)), np.zeros((len(q), 3)))
    known = {plant.world_body().index(): still}

    def poses_of(body) -> Poses:
        if body.index() not in known:
            joint = inboard[body.index()]
            poses = poses_of(joint.parent_body()).moved(joint.frame_on_parent().GetFixedPoseInBodyFrame())
            if isinstance(joint, RevoluteJoint):
                about = q[:, joint.position_start(), None] * joint.revolute_axis()
                turned = scipy.spatial.transform.Rotation.from_rotvec(about).as_matrix()
                poses = Poses(poses.rotation @ turned, poses.position)
            known[body.index()] = poses.moved(joint.frame_on_child().GetFixedPoseInBodyFrame().inverse())
        return known[body.index()]

    return {name: poses_of(plant.GetBodyByName(name)) for name in bodies}
