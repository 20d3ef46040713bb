"""The skeleton on which the paper's authors planned, a double pendulum, as an arm of its own; and an arm as light."""

import re
from dataclasses import replace
from pathlib import Path

from drakearm.model import Arm, load_arm

MASS = 0.2  # kg, of each link, whose moments of inertia are those of rods of the arm's masses all the same
LENGTHS = {"upper_arm": 0.34, "forearm": 0.29}  # m
RODS = {"upper_arm": 1.864572, "forearm": 1.534315}  # kg
GRAVITY = 9.8066  # m/s^2


def authors_pendulum(folder: Path) -> Arm:
    """The pendulum, whose file is written to the folder. Its muscles mean nothing.

    Denizdurduran, Markram, Gewaltig 2022, from their public code. Theirs has absolute angles: elbow is shoulder plus
    elbow of this one, and torques from the world onto each link: elbow torques are equal, shoulder is this one's
    shoulder minus elbow.
    """
    file = folder / "authors_pendulum.urdf"
    file.write_text(
        f'<robot name="authors_pendulum">'
        f"{_link('upper_arm')}{_joint('shoulder', 'world', 'upper_arm', 0.0)}"
        f"{_link('forearm')}{_joint('elbow', 'upper_arm', 'forearm', LENGTHS['upper_arm'])}"
        f'<link name="hand"/><joint name="wrist" type="fixed"><parent link="forearm"/><child link="hand"/>'
        f'<origin xyz="0 {-LENGTHS["forearm"]} 0"/></joint></robot>'
    )
    arm = load_arm("arm14")
    return replace(
        arm,
        name="authors_pendulum",
        skeleton=file,
        gravity=(0.0, -GRAVITY, 0.0),
        load_frame="hand",
        tip_frame="hand",
        muscles=tuple(replace(muscle, points=()) for muscle in arm.muscles),
    )


def lighter(arm: Arm, scale: float, folder: Path) -> Arm:
    """An arm whose masses are scaled and whose moments of inertia are not, as the authors have it."""
    text = re.sub(
        r'mass value="(.*?)"', lambda mass: f'mass value="{scale * float(mass[1])}"', arm.skeleton.read_text()
    )
    file = folder / f"light_{arm.skeleton.name}"
    file.write_text(text)
    return replace(arm, skeleton=file)


def _link(name: str) -> str:
    """A link whose center of mass is in its middle; its moment of inertia is of the form m (L/2)^2 / 3."""
    middle = LENGTHS[name] / 2
    inertia = RODS[name] * middle**2 / 3
    return (
        f'<link name="{name}"><inertial><origin xyz="0 {-middle} 0"/><mass value="{MASS}"/>'
        f'<inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def _joint(name: str, parent: str, child: str, below: float) -> str:
    return (
        f'<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0 {-below} 0"/><axis xyz="0 0 1"/></joint>'
    )
