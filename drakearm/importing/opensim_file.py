"""Loads an OpenSim file in such a way that all coordinates are free to be set, and reads OpenSim's containers."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drakearm.errors import ImportingError, did_you_mean, shown


def import_opensim() -> Any:
    """The package, with its log switched off. Raises ImportingError if it is not installed."""
    before = dict(os.environ)
    try:
        import opensim
    except ImportError as error:
        raise ImportingError(
            "Importing an .osim file needs OpenSim: install it with `pip install opensim`, or drakearm[import]."
        ) from error
    finally:
        # OpenSim puts its own libraries before all others, for every program that this one starts: others fail then.
        os.environ.clear()
        os.environ.update(before)
    opensim.Logger.setLevelString("off")
    return opensim


def load_model(osim: Any, file: Path) -> Any:
    """The model of a file, without a state. Raises ImportingError, with OpenSim's reason, where OpenSim refuses it."""
    try:
        model = osim.Model(str(file))
        model.finalizeConnections()
    except RuntimeError as error:
        raise ImportingError(f"{shown(file)} is refused by OpenSim: {_gist(str(error))}.") from error
    return model


def free_model(osim: Any, file: Path, frozen: Mapping[str, float]) -> tuple[Any, Any]:
    """The model without constraints and with all coordinates unlocked, and its state. frozen: see `_freeze`."""
    model = load_model(osim, file)
    model.updConstraintSet().clearAndDestroy()  # they would change moment arms, and stop coordinates
    for coordinate in items(model.updCoordinateSet()):
        coordinate.set_locked(False)
        coordinate.set_prescribed(False)
        coordinate.set_clamped(False)
    _freeze(osim, model, frozen)
    try:
        return model, model.initSystem()
    except RuntimeError as error:
        raise ImportingError(f"{shown(file)} is refused by OpenSim: {_gist(str(error))}.") from error


def _freeze(osim: Any, model: Any, frozen: Mapping[str, float]) -> None:
    """Makes constants of what some joints do besides turning by their coordinates: its value at an angle (rad)."""
    joints = {joint.getName(): joint for joint in items(model.updJointSet())}
    for name, angle in frozen.items():
        if name not in joints:
            known = ", ".join(joints)
            raise ImportingError(f"The model has no joint {name}{did_you_mean(name, joints)}: expected one of {known}.")
        joint = osim.CustomJoint.safeDownCast(joints[name])
        if joint is None:
            kind = joints[name].getConcreteClassName()
            raise ImportingError(f"The joint {name} is a {kind}, which has nothing to freeze: expected a CustomJoint.")
        transform = joint.updSpatialTransform()
        for i in range(6):
            axis = transform.updTransformAxis(i)
            function = axis.getFunction()
            line = osim.LinearFunction.safeDownCast(function)
            if i >= 3 or line is None or abs(line.getSlope()) != 1.0:
                value = function.calcValue(osim.Vector(function.getArgumentSize(), angle))
                axis.setCoordinateNames(osim.ArrayStr())
                axis.set_function(osim.Constant(value))  # a copy, unlike with setFunction


def items(container: Any) -> list[Any]:
    return [container.get(i) for i in range(container.getSize())]


def base_name(frame: Any) -> str:
    """The body, or the ground, to which a frame belongs."""
    return frame.findBaseFrame().getName()


def base_pose(frame: Any) -> np.ndarray:
    """The pose (4, 4) of a frame in its body."""
    return pose_array(frame.findTransformInBaseFrame())


def pose_array(transform: Any) -> np.ndarray:
    pose = np.eye(4)
    rotation = transform.R().asMat33()
    pose[:3, :3] = [[rotation.get(i, j) for j in range(3)] for i in range(3)]
    pose[:3, 3] = transform.T().to_numpy()
    return pose


def _gist(text: str) -> str:
    """The first sentence of what OpenSim says, without its place in the source code."""
    text = text.split("\n\tThrown at")[0].split("': ", 1)[-1].removeprefix("Object: ")
    lines = [line.strip() for line in text.splitlines() if line.strip() and "Exception thrown at" not in line]
    return " ".join(lines)[:180].rstrip(".")
