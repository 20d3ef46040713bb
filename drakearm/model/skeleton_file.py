"""Reads a skeleton file with Drake's Parser, and checks that it is a skeleton which the arm's muscles can move."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.parsers import expat

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, RevoluteJoint

from drakearm.errors import ArmError, did_you_mean, shown
from drakearm.files import read_text
from drakearm.model.arm import Arm

LOAD = "load"  # name of the body that is welded to the load frame
_KINDS = (".urdf", ".sdf", ".xml")
_REASONS = {  # for texts of Drake that are hard to understand, by what they contain
    r"pos_lower_limits|lower limit must be lower": "a joint's lower limit is above its upper limit",
    r"[Pp]hysically|mass > 0|invalid inertia": "no body has this mass with these moments of inertia",
}
_HARMLESS = r"currently unsupported and will be ignored|<transmission>"  # tags for other programs, as of robots in ROS
_LARGEST_ANGLE = 100.0  # rad, of a joint's limits
_LIGHTEST, _HEAVIEST = 1e-15, 1e9  # kg m^2: moments of inertia about a joint, from an ant's leg to an elephant's
_SINGULAR = 1e-9  # least eigenvalue of the mass matrix, scaled so that its diagonal is 1


def parse_skeleton(plant: MultibodyPlant, file: Path, strict: bool = False) -> ModelInstanceIndex:
    """Adds the skeleton to a plant. Raises ArmError, in one sentence, where Drake's Parser refuses the file.

    strict: whether Drake also refuses what it would ignore or replace with a warning, such as a negative mass.
    """
    parser = Parser(plant)
    parser.package_map().Remove("drake_models")  # Drake would download it
    if strict:
        parser.SetStrictParsing()
    with _drakes_reason(file):
        models = parser.AddModels(str(file))
    if len(models) != 1:
        raise ArmError(f"{shown(file)} has {len(models)} models: expected one.")
    return models[0]


def moving_joints(file: Path) -> tuple[str, ...]:
    """The joints of a skeleton that move, in the order of its positions q. Raises ArmError where Drake refuses it."""
    _require_xml(file)
    plant, model = _strictly_parsed(file)
    joints = [plant.get_joint(index) for index in plant.GetJointIndices(model)]
    with _drakes_reason(file):
        plant.Finalize()
    moving = sorted((joint for joint in joints if joint.num_positions() > 0), key=lambda joint: joint.position_start())
    if not moving:
        raise ArmError(f"{shown(file)}: there is no joint that moves: expected at least one revolute joint.")
    return tuple(joint.name() for joint in moving)


def check_skeleton(arm: Arm) -> None:
    """Raises ArmError where the skeleton is damaged, lacks what the arm names, or cannot be moved by joint torques."""
    file = arm.skeleton
    _require_xml(file)
    plant, model = _strictly_parsed(file)
    _require_names(plant, arm, model)
    _require_joints(plant, arm, model)
    with _drakes_reason(file):
        plant.Finalize()
        _require_coordinates(plant, arm)
        _require_inertia(plant, arm)


def _strictly_parsed(file: Path) -> tuple[MultibodyPlant, ModelInstanceIndex]:
    """A plant with the skeleton. What Drake warns about is an error, except for harmless tags."""
    for strict in (True, False):
        plant = MultibodyPlant(time_step=0.0)
        try:
            return plant, parse_skeleton(plant, file, strict)
        except ArmError as error:
            if not (strict and re.search(_HARMLESS, str(error))):
                raise
    raise AssertionError("the second attempt returns or raises")


@contextmanager
def _drakes_reason(file: Path) -> Iterator[None]:
    """Turns what Drake raises inside the `with` block into an ArmError, which gives Drake's reason in short."""
    try:
        yield
    except ArmError:
        raise
    except (Exception, SystemExit) as error:  # Drake's failed assertions are SystemExit in Python
        raise ArmError(f"{shown(file)} is refused by Drake: {_gist(str(error))}.") from error


def _gist(text: str) -> str:
    """The line and the first sentence of a text of Drake, without paths."""
    line = "".join(f"line {number}: " for number in re.findall(r"^\S*?:(\d+): error: ", text))
    for pattern, reason in _REASONS.items():
        if re.search(pattern, text):
            return line + reason
    text = re.sub(r"^(\S*: )?error: ", "", text)
    if failed := re.search(r"condition '(.*?)' failed", text, re.DOTALL):
        return f"{line}its condition '{failed[1][:80]}' failed"
    return line + re.split(r"\.\s|\n", re.sub(r"/\S*/", "", text), maxsplit=1)[0].rstrip(".:")[:150]


def _require_xml(file: Path) -> None:
    if file.suffix not in _KINDS:
        raise ArmError(f"{shown(file)}: expected a skeleton file with the ending {', '.join(_KINDS)}.")
    text = read_text(file, ArmError)
    if "<!DOCTYPE" in text:
        raise ArmError(f"{shown(file)} has a document type: expected XML without one.")
    try:
        expat.ParserCreate().Parse(text, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages[error.code]
        raise ArmError(f"{shown(file)} is not valid XML in line {error.lineno}: {reason}.") from error


def _require_names(plant: MultibodyPlant, arm: Arm, model: ModelInstanceIndex) -> None:
    """The skeleton must have every frame and body that the arm names, except for its outline (see `read_points`)."""
    file = shown(arm.skeleton)
    for frame in (arm.load_frame or arm.tip_frame, arm.tip_frame):
        if not plant.HasFrameNamed(frame, model):
            frames = [plant.get_frame(index).name() for index in plant.GetFrameIndices(model)]
            hint = did_you_mean(frame, frames)
            raise ArmError(f"{file}: there is no frame {frame}, which the arm {arm.name} names{hint}.")
    attached = [(body, f"where {muscle.name} is attached") for muscle in arm.muscles for body, _ in muscle.points]
    attached += [(surface.body, f"where the surface {surface.name} is") for surface in arm.surfaces]
    bodies = ["world", *(plant.get_body(index).name() for index in plant.GetBodyIndices(model))]
    for body, what in attached:
        if body not in bodies:
            raise ArmError(f"{file}: there is no body {body}, {what}{did_you_mean(body, bodies)}.")
    if plant.HasBodyNamed(LOAD, model):
        raise ArmError(f"{file} has a body {LOAD}: expected another name, because loads in the hand have it.")


def _require_joints(plant: MultibodyPlant, arm: Arm, model: ModelInstanceIndex) -> None:
    """The moving joints must be the arm's coordinates, and revolute."""
    file = shown(arm.skeleton)
    joints = [plant.get_joint(i) for i in plant.GetJointIndices(model)]
    moving = [joint for joint in joints if joint.num_positions() > 0]
    for joint in moving:
        if not isinstance(joint, RevoluteJoint):
            raise ArmError(
                f"{file}: the joint {joint.name()} is {joint.type_name()}: expected revolute or fixed joints."
            )
    names = tuple(joint.name() for joint in moving)
    if sorted(names) != sorted(arm.coordinates):
        raise ArmError(
            f"{file}: the moving joints are {', '.join(names) or 'none'}: expected one-degree-of-freedom joints "
            f"{', '.join(arm.coordinates)}, in this order."
        )
    for joint in moving:
        lower, upper = joint.position_lower_limit(), joint.position_upper_limit()
        if not lower <= upper or any(np.isfinite(x) and abs(x) > _LARGEST_ANGLE for x in (lower, upper)):
            raise ArmError(
                f"{file}: the joint {joint.name()} has the limits {lower:g} and {upper:g} rad: expected a lower and an "
                f"upper one of at most {_LARGEST_ANGLE:g} rad."
            )


def _require_coordinates(plant: MultibodyPlant, arm: Arm) -> None:
    """The positions of the finalized plant must be the arm's coordinates, in their order and without constraints."""
    file = shown(arm.skeleton)
    for body in (plant.get_body(i) for i in plant.GetFloatingBaseBodies()):
        raise ArmError(f"{file}: no joint connects the body {body.name()} to the world: expected one that does.")
    order = tuple(sorted(arm.coordinates, key=lambda name: plant.GetJointByName(name).position_start()))
    if order != arm.coordinates:
        raise ArmError(
            f"{file}: the moving joints are {', '.join(order)}: expected one-degree-of-freedom joints "
            f"{', '.join(arm.coordinates)}, in this order."
        )
    if plant.num_constraints() > 0:
        raise ArmError(f"{file} has constraints, such as mimic joints: expected joints that move independently.")


def _require_inertia(plant: MultibodyPlant, arm: Arm) -> None:
    """Every joint must move bodies that resist, also while the others move, so that accelerations are finite."""
    file, context = shown(arm.skeleton), plant.CreateDefaultContext()
    plant.SetPositions(context, 0.3 + 0.4 * np.arange(len(arm.coordinates)))  # no posture in which axes happen to align
    mass_matrix = plant.CalcMassMatrix(context)
    inertia = np.diag(mass_matrix)
    for name, value in zip(arm.coordinates, inertia, strict=True):
        if not _LIGHTEST <= value <= _HEAVIEST:
            raise ArmError(
                f"{file}: the joint {name} moves bodies with a moment of inertia of {value:.3g} kg m^2 about it: "
                f"expected {_LIGHTEST:g} to {_HEAVIEST:g} kg m^2."
            )
    coupling = mass_matrix / np.sqrt(np.outer(inertia, inertia))
    if not (np.isfinite(coupling).all() and np.linalg.eigvalsh(coupling)[0] > _SINGULAR):
        raise ArmError(
            f"{file}: the joints {', '.join(arm.coordinates)} can move without moving any mass: expected a mass or "
            "different axes for each."
        )
