"""Imports a limb: from a file of another program to a folder that drakearm can load."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from drakearm.errors import ImportingError, PathError, did_you_mean, shown
from drakearm.importing.links import Link, make_links
from drakearm.importing.selection import Selection, select
from drakearm.importing.source import GROUND, Program, SourceModel, SourceMuscle
from drakearm.model.path_fit import PathFit, fit_paths
from drakearm.model.path_samples import PathSampler

GRIP, TIP = "grip", "tip"  # the frames where loads hang, and whose path is planned and drawn
_SEARCH = 16  # times 256 samples in search of jumps: faults of OpenSim's wrapping can be narrower than 0.1 degrees


@dataclass(frozen=True)
class ImportedLimb:
    """What a limb's folder will hold."""

    model: SourceModel
    selection: Selection
    links: tuple[Link, ...]
    muscles: tuple[SourceMuscle, ...]  # their points are in the links' frames
    fits: tuple[PathFit, ...]  # of these muscles
    frames: dict[str, tuple[str, np.ndarray]]  # GRIP and TIP: a link, and the position in it
    notes: tuple[str, ...]  # what was left out or changed, in words


def open_program(file: Path, frozen: Mapping[str, float]) -> Program:
    """The program that the file's ending tells, with the model loaded. frozen: joint -> degrees, for OpenSim."""
    if not file.is_file():
        raise ImportingError(f"There is no file {shown(file)}: expected a model of OpenSim (.osim) or MuJoCo (.xml).")
    if file.suffix == ".osim":
        from drakearm.importing.opensim_model import OpenSimProgram

        return OpenSimProgram(file, {joint: math.radians(angle) for joint, angle in frozen.items()})
    if file.suffix == ".xml":
        from drakearm.importing.mujoco_model import MujocoProgram

        if frozen:
            raise ImportingError("Joints of MuJoCo cannot be frozen: expected --lock with the joint that shifts.")
        return MujocoProgram(file)
    raise ImportingError(f"{shown(file)}: expected a model of OpenSim (.osim) or MuJoCo (.xml).")


def import_limb(
    file: Path,
    only: Sequence[str] = (),
    locks: Mapping[str, float] | None = None,
    frozen: Mapping[str, float] | None = None,
    tip: tuple[str, tuple[float, float, float]] | None = None,
) -> ImportedLimb:
    """Reads a model, takes the part that becomes the limb, and fits its muscles' paths.

    only: the bodies to keep; by default all. locks: coordinate -> degrees, or m where it shifts: coordinates that do
    not move. frozen: joint of OpenSim -> degrees: joints that keep what they do besides turning as it is there.
    tip: a body and a position (m) in it; by default the mass center of the most distal body.

    Raises ImportingError, in one sentence that names the part of the file, for what cannot be imported.
    """
    program = open_program(file, frozen or {})
    model = program.model
    known = model.coordinates
    values = {
        name: math.radians(value) if name in known and known[name].kind == "rotation" else value
        for name, value in (locks or {}).items()
    }
    selection = select(model, only, values)
    program.set_coordinates(values)
    links = make_links(program, selection)
    frames = _frames(selection, links, tip)
    neutral = {
        name: float(np.clip(known[name].default, lower, upper)) for name, (lower, upper) in selection.limits.items()
    }
    program.set_coordinates(neutral)
    muscles, notes = _choose_muscles(model, selection)
    fits = _fit(program, muscles, selection.limits, np.array(list(neutral.values())))
    crossing = [fit for fit in fits if fit.terms]
    idle = [fit.muscle for fit in fits if not fit.terms]
    if idle:
        notes.append(f"muscles that cross no joint are left out: {', '.join(idle)}")
    if not crossing:
        raise ImportingError(f"No muscle of {model.name} can be kept: {'; '.join(notes) or 'it has none'}.")
    shifts = {link.name: link.shift for link in links}
    placed = [
        replace(m, points=tuple((b, tuple((shifts[b] + point).tolist())) for b, point in m.points)) for m in muscles
    ]
    return ImportedLimb(
        model,
        selection,
        tuple(links),
        tuple(muscle for muscle in placed if muscle.name not in idle),
        tuple(crossing),
        frames,
        (*selection.notes, *notes, *(f"left out: {note}" for note in model.notes)),
    )


def _choose_muscles(model: SourceModel, selection: Selection) -> tuple[list[SourceMuscle], list[str]]:
    """The muscles that touch only kept bodies, and which are left out."""
    kept = {*selection.bodies, *((GROUND,) if GROUND in selection.roots else ())}
    outside = [muscle.name for muscle in model.muscles if not muscle.bodies <= kept]
    notes = [f"muscles that leave the kept bodies are left out: {', '.join(outside)}"] if outside else []
    return [muscle for muscle in model.muscles if muscle.name not in outside], notes


def _fit(
    program: Program,
    muscles: Sequence[SourceMuscle],
    limits: Mapping[str, tuple[float, float]],
    neutral: np.ndarray,
) -> list[PathFit]:
    if not muscles:
        return []
    names = [muscle.name for muscle in muscles]
    extra = np.array([muscle.extra_length for muscle in muscles])
    sample = program.sampler(names, list(limits))

    def lengthened(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        length, arms = sample(q)
        return length + extra, arms

    lower, upper = np.array(list(limits.values())).T
    sampler: PathSampler = lengthened
    try:
        return fit_paths(sampler, names, list(limits), lower, upper, neutral, search=_SEARCH)
    except PathError as error:
        raise ImportingError(f"{error} Lock one of them with --lock.") from error


def _frames(
    selection: Selection,
    links: Sequence[Link],
    tip: tuple[str, tuple[float, float, float]] | None,
) -> dict[str, tuple[str, np.ndarray]]:
    by_name = {link.name: link for link in links}
    if tip is not None and tip[0] not in selection.bodies:
        names = [body for body in selection.bodies if body != GROUND]
        raise ImportingError(
            f"There is no body {tip[0]} for the tip{did_you_mean(tip[0], names)}: expected one of {', '.join(names)}."
        )
    body = tip[0] if tip else _most_distal(by_name)
    link = by_name[body]
    center = link.body.com if link.body else np.zeros(3)
    point = np.array(tip[1]) if tip else center
    return {GRIP: (body, link.shift + center), TIP: (body, link.shift + point)}


def _most_distal(links: Mapping[str, Link]) -> str:
    """The body with mass after most hinges, of several the one with its mass center farthest from the last hinge."""

    def place(name: str) -> tuple[int, float]:
        body = links[name].body
        point = (body.com if body else np.zeros(3)) + links[name].shift
        hinges, distance = 0, float(np.linalg.norm(point))
        while name in links:
            link = links[name]
            if link.axis is not None:
                if hinges == 0:
                    distance = float(np.linalg.norm(point))
                hinges += 1
            point = link.origin[:3, :3] @ point + link.origin[:3, 3]
            name = link.parent
        return hinges, distance

    heavy = [name for name, link in links.items() if link.body and link.body.mass > 0.0]
    return max(heavy or links, key=place)


def limb_name(text: str) -> str:
    """A name for a limb, and for its folder: letters, digits, - and _."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", text).strip("_") or "limb"
