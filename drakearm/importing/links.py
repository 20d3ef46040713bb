"""The limb's skeleton as links, each with one hinge or none: what a URDF file can hold."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from drakearm.errors import ImportingError
from drakearm.importing.hinges import find_hinges
from drakearm.importing.selection import Selection
from drakearm.importing.source import GROUND, Body, Joint, Program

WORLD = "world"


@dataclass(frozen=True)
class Link:
    """A link and the joint that carries it. Its frame is the joint's, and parallel to the body's."""

    name: str
    parent: str  # a link, or WORLD
    joint: str  # the coordinate, where it moves
    origin: np.ndarray  # (4, 4), of the joint in the parent link
    axis: np.ndarray | None  # (3,), or None if it is fixed
    body: Body | None  # None for the ground and between the hinges of one joint
    shift: np.ndarray  # (3,), of the body's origin in the link


def make_links(program: Program, selection: Selection) -> list[Link]:
    """The links of a selection, parents first. The program's coordinates must have their locked values.

    Raises ImportingError for a joint that is not a series of rotations, each by one coordinate about one axis.
    """
    bodies, poses = program.model.bodies, program.poses()
    links = {}
    for root in selection.roots:
        pose = poses.get(root, np.eye(4))
        links[root] = Link(root, WORLD, f"{root}_to_world", pose, None, bodies.get(root), np.zeros(3))
    for joint in selection.joints:
        parent = links[joint.parent]
        for link in _joint_links(program, joint, parent, selection.limits):
            links[link.name] = link
    return list(links.values())


def _joint_links(program: Program, joint: Joint, parent: Link, limits: Mapping[str, tuple[float, float]]) -> list[Link]:
    moving = [name for name in joint.coordinates if name in limits]
    lower, upper = (np.array([limits[name][side] for name in moving]) for side in (0, 1))
    base = np.clip(np.zeros(len(moving)), lower, upper)

    def pose(q: np.ndarray) -> np.ndarray:
        program.set_coordinates(dict(zip(moving, q.tolist(), strict=True)))
        poses = {GROUND: np.eye(4), **program.poses()}
        return np.linalg.inv(poses[joint.parent]) @ poses[joint.child]

    hinges = find_hinges(pose, base, lower, upper) if moving else ()
    if hinges is None:
        raise ImportingError(
            f"The joint {joint.name} is not a rotation about one axis for each of {', '.join(moving)}: if it also "
            f"shifts or turns otherwise, keep that as it is at an angle with --freeze {joint.name}=DEG, or fix the "
            f"whole joint with --lock {moving[0]}=DEG."
        )
    start, before = pose(base), _translation(parent.shift)
    body = program.model.bodies[joint.child]
    if not hinges:
        name = joint.name if joint.name not in program.model.coordinates else f"{joint.name}_fixed"
        return [Link(joint.child, parent.name, name, before @ start, None, body, np.zeros(3))]
    links: list[Link] = []
    for hinge in hinges:
        name = moving[hinge.coordinate]
        above = links[-1].name if links else parent.name
        origin = before @ _translation(hinge.point)
        links.append(Link(f"{joint.child}_{name}", above, name, origin, hinge.axis, None, np.zeros(3)))
        back = Rotation.from_rotvec(-base[hinge.coordinate] * hinge.axis).as_matrix()
        before = np.eye(4)
        before[:3, :3], before[:3, 3] = back, -back @ hinge.point
    rest = before @ start  # the body in the last hinge's frame
    turn = np.eye(4)
    turn[:3, :3] = rest[:3, :3]
    last, axis = links.pop(), turn[:3, :3].T @ hinge.axis
    shift = turn[:3, :3].T @ rest[:3, 3]
    return [*links, Link(joint.child, last.parent, last.joint, last.origin @ turn, axis, body, shift)]


def _translation(vector: np.ndarray) -> np.ndarray:
    result = np.eye(4)
    result[:3, 3] = vector
    return result
