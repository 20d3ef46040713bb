"""Simple bones for the bodies of a skeleton that have no visual shapes of their own."""

import numpy as np
from pydrake.geometry import Capsule, Shape, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FrameIndex, RigidBody

_THICKNESS = 0.045  # radius over length
_JOINT = 1.6  # radius of the ball at a joint over that of the bone
_SHORTEST = 1e-3  # m


def plain_bones(plant: MultibodyPlant, body: RigidBody) -> list[tuple[RigidTransform, Shape]]:
    """Shapes with their poses X_BG: a rod from the body's origin to each of its other frames, and a ball at the origin.

    These frames are where its joints are, and where a hand's tip is. The world and bodies without such frames have
    none.
    """
    if body.index() == plant.world_body().index():
        return []
    frames = [plant.get_frame(FrameIndex(i)) for i in range(plant.num_frames())]
    own = [f for f in frames if f.body().index() == body.index()]
    ends = np.array([f.GetFixedPoseInBodyFrame().translation() for f in own])
    lengths = np.linalg.norm(ends, axis=1)
    ends = np.unique(ends[lengths > _SHORTEST].round(6), axis=0)
    if not len(ends):
        return []
    radius = _THICKNESS * float(lengths.max())
    bones: list[tuple[RigidTransform, Shape]] = [(RigidTransform(), Sphere(_JOINT * radius))]
    for end in ends:
        turned = RotationMatrix.MakeFromOneVector(end, 2)
        bones.append((RigidTransform(turned, 0.5 * end), Capsule(radius, float(np.linalg.norm(end)))))
    return bones
