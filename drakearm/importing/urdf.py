"""Writes links as a URDF file for Drake's Parser, with simple shapes instead of bones."""

from collections.abc import Mapping, Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from pydrake.math import RollPitchYaw, RotationMatrix
from scipy.spatial.transform import Rotation

from drakearm.importing.links import Link
from drakearm.importing.source import Shape

_COLORS = {"bone": "0.93 0.89 0.80 1", "wrap": "0.45 0.62 0.78 0.35"}
_EFFORT, _VELOCITY = "200", "30"  # URDF requires them; neither limits a limb with muscles
_SHORTEST_BONE = 0.01  # m: shorter ones are not drawn
_SLENDERNESS, _THICKEST = 0.06, 0.02  # radius of a bone over its length, and m


def write_urdf(
    name: str,
    links: Sequence[Link],
    limits: Mapping[str, tuple[float, float]],
    frames: Mapping[str, tuple[str, np.ndarray]],
) -> str:
    """The text of a URDF file. frames: names of frames -> a link, and the position (m) in it."""
    robot = Element("robot", {"name": name, "xmlns:drake": "http://drake.mit.edu"})
    for material, color in _COLORS.items():
        SubElement(SubElement(robot, "material", {"name": material}), "color", {"rgba": color})
    for link in links:
        element = SubElement(robot, "link", {"name": link.name})
        _inertial(element, link)
        if link.body is not None:
            ends = [child.origin[:3, 3] for child in links if child.parent == link.name]
            _bones(element, [*ends, *(point for frame, point in frames.values() if frame == link.name)])
        for shape in link.body.shapes if link.body else ():
            _wrap(element, shape, link.shift)
    for link in links:
        _joint(robot, link, limits)
    for frame, (body, point) in frames.items():
        SubElement(robot, "frame", {"name": frame, "link": body, "xyz": _text(point), "rpy": "0 0 0"})
    ElementTree.indent(robot)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(robot, encoding="unicode") + "\n"


def _inertial(element: Element, link: Link) -> None:
    body = link.body
    if body is None or body.mass == 0.0:
        return
    inertial = SubElement(element, "inertial")
    SubElement(inertial, "origin", {"xyz": _text(body.com + link.shift)})
    SubElement(inertial, "mass", {"value": repr(body.mass)})
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    moments = {"ixx": xx, "iyy": yy, "izz": zz, "ixy": xy, "ixz": xz, "iyz": yz}
    SubElement(inertial, "inertia", {key: _text([value]) for key, value in moments.items()})


def _joint(robot: Element, link: Link, limits: Mapping[str, tuple[float, float]]) -> None:
    kind = "fixed" if link.axis is None else "revolute"
    joint = SubElement(robot, "joint", {"name": link.joint, "type": kind})
    SubElement(joint, "parent", {"link": link.parent})
    SubElement(joint, "child", {"link": link.name})
    _origin(joint, link.origin)
    if link.axis is not None:
        lower, upper = limits[link.joint]
        SubElement(joint, "axis", {"xyz": _text(link.axis)})
        limit = {"lower": repr(lower), "upper": repr(upper), "effort": _EFFORT, "velocity": _VELOCITY}
        SubElement(joint, "limit", limit)


def _bones(element: Element, ends: Sequence[np.ndarray]) -> None:
    """Capsules from the link's origin to its joints and frames."""
    for i, end in enumerate(ends):
        length = float(np.linalg.norm(end))
        if length > _SHORTEST_BONE and not any(np.allclose(end, other) for other in ends[:i]):
            pose = np.eye(4)
            pose[:3, :3] = Rotation.align_vectors([end / length], [[0.0, 0.0, 1.0]])[0].as_matrix()
            pose[:3, 3] = 0.5 * end
            radius = min(_SLENDERNESS * length, _THICKEST)
            size = {"radius": _text([radius]), "length": _text([length - 2.0 * radius])}
            _visual(element, f"bone{i}", pose, "capsule", size, "bone")


def _wrap(element: Element, shape: Shape, shift: np.ndarray) -> None:
    pose = shape.pose.copy()
    pose[:3, 3] += shift
    kind = "drake:ellipsoid" if shape.kind == "ellipsoid" else shape.kind
    names = {"sphere": ("radius",), "cylinder": ("radius", "length"), "ellipsoid": ("a", "b", "c")}[shape.kind]
    _visual(element, shape.name, pose, kind, dict(zip(names, map(repr, shape.size), strict=True)), "wrap")


def _visual(element: Element, name: str, pose: np.ndarray, kind: str, size: Mapping[str, str], material: str) -> None:
    visual = SubElement(element, "visual", {"name": name})
    _origin(visual, pose)
    SubElement(SubElement(visual, "geometry"), kind, dict(size))
    SubElement(visual, "material", {"name": material})


def _origin(element: Element, pose: np.ndarray) -> None:
    angles = RollPitchYaw(RotationMatrix.ProjectToRotationMatrix(pose[:3, :3]))
    SubElement(element, "origin", {"xyz": _text(pose[:3, 3]), "rpy": _text(angles.vector())})


def _text(numbers: Sequence[float] | np.ndarray) -> str:
    return " ".join(f"{round(float(x), 12) + 0.0:.12g}" for x in numbers)  # + 0.0: without -0
