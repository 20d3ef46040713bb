"""Which bodies and coordinates of a model become the limb, as the user and the file say."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from drakearm.errors import ImportingError, did_you_mean
from drakearm.importing.source import GROUND, Coordinate, Joint, SourceModel

_MOST_COORDINATES = 4
_WIDEST = 2.0 * math.pi  # rad: limits beyond are no limits


@dataclass(frozen=True)
class Selection:
    """A part of a model: joints in the order of the tree, and the coordinates that remain."""

    roots: tuple[str, ...]  # bodies that are fixed in the world, or GROUND
    joints: tuple[Joint, ...]  # between kept bodies, parents first
    limits: dict[str, tuple[float, float]]  # of the free coordinates, rad, in the order of the joints
    notes: tuple[str, ...]

    @property
    def bodies(self) -> tuple[str, ...]:
        return (*self.roots, *(joint.child for joint in self.joints))


def select(model: SourceModel, only: Iterable[str], locks: Mapping[str, float]) -> Selection:
    """The part of a model that becomes the limb.

    only: the bodies to keep, or none to keep all; those whose parent is not kept are fixed in the world. locks:
    coordinates that keep a value, besides those that are locked in the file.

    Raises ImportingError for unknown names and for what a limb cannot have.
    """
    only = tuple(only)
    _require_known(only, [GROUND, *model.bodies], "body")
    _require_known(locks, model.coordinates, "coordinate")
    kept = only or (GROUND, *model.bodies)
    joints = _in_order(model, kept)
    moved = [joint.child for joint in joints]
    roots = tuple(body for body in kept if body not in moved)
    notes = [f"{body} is fixed in the world, because its parent is not kept" for body in roots if body != GROUND]
    moving = []
    for name in (name for joint in joints for name in joint.coordinates):
        coordinate = model.coordinates[name]
        if name in locks or coordinate.locked:
            value = locks.get(name, coordinate.default)
            degrees = f"{math.degrees(value):g} degrees" if coordinate.kind == "rotation" else f"{value:g} m"
            notes.append(f"{name} is locked at {degrees}" + (", as in the file" if name not in locks else ""))
        else:
            moving.append(coordinate)
    _require_rotations(moving)
    limits = {coordinate.name: _limits(coordinate, notes) for coordinate in moving}
    if not 0 < len(limits) <= _MOST_COORDINATES:
        raise ImportingError(
            f"{model.name} has {len(limits)} coordinates that move{_listed(limits)}: expected 1 to "
            f"{_MOST_COORDINATES}. Lock some with --lock COORDINATE=DEG, or keep fewer bodies with --only."
        )
    return Selection(roots, tuple(joints), limits, tuple(notes))


def _require_known(names: Iterable[str], known: Iterable[str], what: str) -> None:
    known = list(known)
    for name in names:
        if name not in known:
            raise ImportingError(
                f"The model has no {what} {name}{did_you_mean(name, known)}: expected one of {', '.join(known)}."
            )


def _in_order(model: SourceModel, kept: tuple[str, ...]) -> list[Joint]:
    """The joints between kept bodies, parents first."""
    between = [joint for joint in model.joints if joint.parent in kept and joint.child in kept]
    children = [joint.child for joint in between]
    for child in children:
        if children.count(child) > 1:
            raise ImportingError(f"The body {child} is the child of several joints: expected a tree of bodies.")
    ordered: list[Joint] = []
    placed = [body for body in kept if body not in children]
    while len(ordered) < len(between):
        ready = [joint for joint in between if joint.parent in placed and joint not in ordered]
        if not ready:
            raise ImportingError(f"The bodies {', '.join(children)} form a loop: expected a tree of bodies.")
        ordered += ready
        placed += [joint.child for joint in ready]
    return ordered


def _require_rotations(coordinates: list[Coordinate]) -> None:
    """Raises ImportingError, which names all coordinates that have the same problem."""
    if followers := [f"{c.name} follows {c.follows}" for c in coordinates if c.follows]:
        raise ImportingError(
            f"Constraints couple coordinates ({', '.join(followers)}): lock those that follow with --lock, or leave "
            "their bodies out with --only."
        )
    for kind in (c.kind for c in coordinates if c.kind != "rotation"):
        names = ", ".join(c.name for c in coordinates if c.kind == kind)
        cure = "lock them with --lock COORDINATE=METERS, or " if kind == "translation" else ""
        raise ImportingError(
            f"Not a rotation about one axis, but a {kind}: {names}. Please {cure}leave the joints out with --only: a "
            "body whose parent is not kept is fixed in the world."
        )


def _limits(coordinate: Coordinate, notes: list[str]) -> tuple[float, float]:
    name = coordinate.name
    lower, upper = max(coordinate.lower, -_WIDEST), min(coordinate.upper, _WIDEST)
    if not lower < upper:
        raise ImportingError(f"The range of {name} is {coordinate.lower:g} to {coordinate.upper:g} rad: it is empty.")
    if upper - lower > _WIDEST:
        lower, upper = -math.pi, math.pi
        notes.append(f"{name} has no range in the file: its joint gets -180 to 180 degrees")
    return lower, upper


def _listed(names: Iterable[str]) -> str:
    text = ", ".join(names)
    return f" ({text})" if text else ""
