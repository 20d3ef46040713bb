"""What the importers of all programs produce: a model in neutral terms, and a program that can be asked about it.

Units: m, kg, rad, N, s. Poses are homogeneous transforms (4, 4).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

import numpy as np

from drakearm.model.path_samples import PathSampler

GROUND = "ground"


@dataclass(frozen=True)
class Coordinate:
    name: str
    kind: str  # "rotation", or what else it is, in words
    lower: float
    upper: float
    default: float
    locked: bool  # by the file
    follows: str = ""  # the coordinate to which a constraint couples this one


@dataclass(frozen=True)
class Shape:
    """A surface over which muscles wrap, for drawing."""

    name: str
    kind: Literal["sphere", "cylinder", "ellipsoid"]  # the axis of a cylinder is z
    size: tuple[float, ...]  # radius; radius, length; three half axes
    pose: np.ndarray  # in the body


@dataclass(frozen=True)
class Body:
    name: str
    mass: float
    com: np.ndarray  # (3,)
    inertia: np.ndarray  # (3, 3), about the center of mass, along the body's axes
    shapes: tuple[Shape, ...] = ()


@dataclass(frozen=True)
class Joint:
    name: str
    parent: str  # a body, or GROUND
    child: str
    coordinates: tuple[str, ...]


@dataclass(frozen=True)
class SourceMuscle:
    name: str
    fields: dict[str, Any]  # of a muscle in a muscles.yaml, without path and points
    points: tuple[tuple[str, tuple[float, ...]], ...]  # a body, and the position in it, at the default posture
    bodies: frozenset[str]  # that the path touches
    notes: tuple[str, ...] = ()  # what is not kept
    extra_length: float = 0.0  # to be added to the lengths of the path: tendon_slack_length has it, too


@dataclass(frozen=True)
class SourceModel:
    name: str
    program: str  # with its version
    gravity: np.ndarray  # (3,)
    bodies: dict[str, Body]  # without the ground
    joints: tuple[Joint, ...]
    coordinates: dict[str, Coordinate]
    muscles: tuple[SourceMuscle, ...]
    credits: str
    notes: tuple[str, ...] = field(default=())  # what is not kept


class Program(Protocol):
    """A model in its own program."""

    model: SourceModel

    def set_coordinates(self, values: Mapping[str, float]) -> None:
        """Sets some coordinates (rad, m). The others keep their values, at first the defaults."""

    def poses(self) -> dict[str, np.ndarray]:
        """The poses of all bodies in the ground, at the present coordinates."""

    def sampler(self, muscles: Sequence[str], coordinates: Sequence[str]) -> PathSampler:
        """Lengths and moment arms of muscles as functions of these coordinates; the others keep their values."""
