"""A model in OpenSim, which computes poses, muscle lengths and moment arms."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drakearm.importing.opensim_file import (
    base_name,
    base_pose,
    free_model,
    import_opensim,
    items,
    load_model,
    pose_array,
)
from drakearm.importing.opensim_muscles import read_muscles
from drakearm.importing.source import Body, Coordinate, Joint, Shape, SourceModel
from drakearm.model.path_samples import PathSampler

_TRANSLATION = 2  # of the motion types of opensim.Coordinate


class OpenSimProgram:
    """A model that OpenSim has loaded. frozen: joints that turn only, with the rest as it is at an angle (rad)."""

    def __init__(self, file: Path, frozen: Mapping[str, float]) -> None:
        self._osim = import_opensim()
        self._file, self._frozen = file, frozen
        self._values: dict[str, float] = {}
        original = load_model(self._osim, file)  # free_model loses its constraints and locks
        self._load()
        self.model = self._read(original)

    def set_coordinates(self, values: Mapping[str, float]) -> None:
        self._values.update(values)
        for name, value in values.items():
            self._coordinates[name].setValue(self._state, float(value), False)
        self._loaded.realizePosition(self._state)

    def poses(self) -> dict[str, np.ndarray]:
        return {
            body.getName(): pose_array(body.getTransformInGround(self._state))
            for body in items(self._loaded.getBodySet())
        }

    def sampler(self, muscles: Sequence[str], coordinates: Sequence[str]) -> PathSampler:
        def sample(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            length = np.empty((len(q), len(muscles)))
            arms = np.empty((len(q), len(muscles), len(coordinates)))
            for k, posture in enumerate(q):
                self.set_coordinates(dict(zip(coordinates, posture.tolist(), strict=True)))
                for i, name in enumerate(muscles):
                    length[k, i] = self._muscles[name].getLength(self._state)
                    for j, coordinate in enumerate(coordinates):
                        arm = self._muscles[name].computeMomentArm(self._state, self._coordinates[coordinate])
                        arms[k, i, j] = arm
                if np.isnan(arms[k]).any():  # else OpenSim answers nan at all later postures, too
                    self._load()
            return length, arms

        return sample

    def _load(self) -> None:
        self._loaded, self._state = free_model(self._osim, self._file, self._frozen)
        coordinates = items(self._loaded.getCoordinateSet())
        self._coordinates = {coordinate.getName(): coordinate for coordinate in coordinates}
        self._muscles = {muscle.getName(): muscle for muscle in items(self._loaded.getMuscles())}
        self.set_coordinates({c.getName(): c.getDefaultValue() for c in coordinates} | self._values)

    def _read(self, original: Any) -> SourceModel:
        follows, notes = {}, []
        for constraint in items(original.getConstraintSet()):
            coupler = self._osim.CoordinateCouplerConstraint.safeDownCast(constraint)
            if coupler is None:
                notes.append(f"the constraint {constraint.getName()} ({constraint.getConcreteClassName()})")
            else:
                leaders = coupler.getIndependentCoordinateNames()
                names = [leaders.get(i) for i in range(leaders.getSize())]
                follows[coupler.getDependentCoordinateName()] = " and ".join(names)
        coordinates = {
            c.getName(): Coordinate(
                c.getName(),
                "translation" if self._coordinates[c.getName()].getMotionType() == _TRANSLATION else "rotation",
                c.getRangeMin(),
                c.getRangeMax(),
                c.getDefaultValue(),
                c.getDefaultLocked() or c.getDefaultIsPrescribed(),
                follows.get(c.getName(), ""),
            )
            for c in items(original.getCoordinateSet())
        }
        muscles, lost = read_muscles(self._osim, self._loaded, self._state)
        texts = (self._loaded.get_credits(), self._loaded.get_publications())
        return SourceModel(
            self._loaded.getName() or self._file.stem,
            f"OpenSim {self._osim.GetVersion().split('-')[0]}",
            self._loaded.getGravity().to_numpy(),
            {body.getName(): self._body(body) for body in items(self._loaded.getBodySet())},
            tuple(_joint(joint) for joint in items(self._loaded.getJointSet())),
            coordinates,
            muscles,
            "\n\n".join(text.strip() for text in texts if text.strip()),
            (*notes, *lost),
        )

    def _body(self, body: Any) -> Body:
        moments, products = body.getInertia().getMoments().to_numpy(), body.getInertia().getProducts().to_numpy()
        (xx, yy, zz), (xy, xz, yz) = moments, products
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        wraps = [self._shape(wrap, base_pose(body)) for wrap in items(body.getWrapObjectSet())]
        shapes = tuple(shape for shape in wraps if shape is not None)
        return Body(body.getName(), body.getMass(), body.getMassCenter().to_numpy(), inertia, shapes)

    def _shape(self, wrap: Any, frame: np.ndarray) -> Shape | None:
        """The shape of a wrap surface; None for a torus, which URDF does not have."""
        pose = frame @ pose_array(wrap.getTransform())
        if cylinder := self._osim.WrapCylinder.safeDownCast(wrap):
            return Shape(wrap.getName(), "cylinder", (cylinder.get_radius(), cylinder.get_length()), pose)
        if sphere := self._osim.WrapSphere.safeDownCast(wrap):
            return Shape(wrap.getName(), "sphere", (sphere.get_radius(),), pose)
        if ellipsoid := self._osim.WrapEllipsoid.safeDownCast(wrap):
            return Shape(wrap.getName(), "ellipsoid", tuple(ellipsoid.get_dimensions().to_numpy().tolist()), pose)
        return None


def _joint(joint: Any) -> Joint:
    coordinates = [joint.get_coordinates(i).getName() for i in range(joint.numCoordinates())]
    return Joint(
        joint.getName(), base_name(joint.getParentFrame()), base_name(joint.getChildFrame()), tuple(coordinates)
    )
