"""A model in MuJoCo, which computes poses, and lengths and moment arms of tendons."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from drakearm.errors import ImportingError, shown
from drakearm.importing.mujoco_muscles import read_muscles
from drakearm.importing.source import GROUND, Body, Coordinate, Joint, Shape, SourceModel
from drakearm.model.path_samples import PathSampler


class MujocoProgram:
    """A model that MuJoCo has loaded."""

    def __init__(self, file: Path) -> None:
        try:
            import mujoco
        except ImportError as error:
            raise ImportingError(
                "Importing a MuJoCo file needs MuJoCo: install it with `pip install mujoco`, or drakearm[import]."
            ) from error
        self._mujoco = mujoco
        try:
            self._loaded = mujoco.MjModel.from_xml_path(str(file))
        except ValueError as error:
            reason = " ".join(str(error).split())[:150]
            raise ImportingError(f"{shown(file)} is refused by MuJoCo: {reason}.") from error
        self._data = mujoco.MjData(self._loaded)
        self._joints = {_name(self._loaded.joint(i), "joint"): i for i in range(self._loaded.njnt)}
        self._actuators = {_name(self._loaded.actuator(i), "actuator"): i for i in range(self._loaded.nu)}
        self._compute()
        self.model = self._read(file)

    def set_coordinates(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            self._data.qpos[self._loaded.jnt_qposadr[self._joints[name]]] = value
        self._compute()

    def poses(self) -> dict[str, np.ndarray]:
        poses = {}
        for i in range(1, self._loaded.nbody):
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = self._data.xmat[i].reshape(3, 3), self._data.xpos[i]
            poses[self._body_name(i)] = pose
        return poses

    def sampler(self, muscles: Sequence[str], coordinates: Sequence[str]) -> PathSampler:
        rows = [self._actuators[name] for name in muscles]
        columns = [self._loaded.jnt_dofadr[self._joints[name]] for name in coordinates]
        moment = np.empty((self._loaded.nu, self._loaded.nv))

        def sample(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            length = np.empty((len(q), len(rows)))
            arms = np.empty((len(q), len(rows), len(columns)))
            d = self._data
            for k, posture in enumerate(q):
                self.set_coordinates(dict(zip(coordinates, posture.tolist(), strict=True)))
                self._mujoco.mju_sparse2dense(
                    moment, d.actuator_moment, d.moment_rownnz, d.moment_rowadr, d.moment_colind
                )
                length[k] = d.actuator_length[rows]
                arms[k] = -moment[np.ix_(rows, columns)]
            return length, arms

        return sample

    def _compute(self) -> None:
        for step in ("mj_kinematics", "mj_comPos", "mj_tendon", "mj_transmission"):
            getattr(self._mujoco, step)(self._loaded, self._data)

    def _body_name(self, i: int) -> str:
        return _name(self._loaded.body(i), "body") if i else GROUND

    def _read(self, file: Path) -> SourceModel:
        loaded, mujoco = self._loaded, self._mujoco
        follows, notes = {}, []
        for i in range(loaded.neq):
            if loaded.eq_type[i] == mujoco.mjtEq.mjEQ_JOINT:
                first, second = loaded.eq_obj1id[i], loaded.eq_obj2id[i]
                names = list(self._joints)
                follows[names[first]] = names[second] if second >= 0 else "a constant"
            else:
                notes.append(f"the equality constraint {loaded.eq(i).name or i}")
        coordinates = {name: self._coordinate(name, i, follows.get(name, "")) for name, i in self._joints.items()}
        kinds = {
            "damping": loaded.dof_damping,
            "friction": loaded.dof_frictionloss,
            "armature": loaded.dof_armature,
            "stiffness": loaded.jnt_stiffness,
        }
        notes += [f"{kind} of joints, up to {np.max(v):g} (SI)" for kind, v in kinds.items() if np.any(v != 0.0)]
        muscles, lost = read_muscles(mujoco, loaded, self._data, self._actuators, self._body_name)
        bodies = [self._body(i) for i in range(1, loaded.nbody)]
        name = loaded.names[: loaded.names.index(b"\0")].decode() or file.stem
        return SourceModel(
            name,
            f"MuJoCo {mujoco.__version__}",
            loaded.opt.gravity.copy(),
            {body.name: body for body in bodies},
            tuple(self._joint(i, name) for i, name in enumerate(body.name for body in bodies)),
            coordinates,
            muscles,
            _first_comment(file),
            (*notes, *lost),
        )

    def _coordinate(self, name: str, i: int, follows: str) -> Coordinate:
        loaded, kinds = self._loaded, self._mujoco.mjtJoint
        kind = {kinds.mjJNT_HINGE: "rotation", kinds.mjJNT_SLIDE: "translation", kinds.mjJNT_BALL: "ball joint"}
        lower, upper = loaded.jnt_range[i] if loaded.jnt_limited[i] else (-np.inf, np.inf)
        default = loaded.qpos0[loaded.jnt_qposadr[i]]
        return Coordinate(
            name,
            kind.get(kinds(loaded.jnt_type[i]), "free joint"),
            float(lower),
            float(upper),
            float(default),
            False,
            follows,
        )

    def _joint(self, index: int, child: str) -> Joint:
        body = index + 1
        first, count = self._loaded.body_jntadr[body], self._loaded.body_jntnum[body]
        names = list(self._joints)[first : first + count] if count else []
        parent = self._body_name(self._loaded.body_parentid[body])
        return Joint(names[0] if len(names) == 1 else f"{child}_joint", parent, child, tuple(names))

    def _body(self, i: int) -> Body:
        loaded = self._loaded
        turn = Rotation.from_quat(loaded.body_iquat[i], scalar_first=True).as_matrix()
        inertia = turn @ np.diag(loaded.body_inertia[i]) @ turn.T
        wrapped = {
            int(loaded.wrap_objid[k])
            for k in range(loaded.nwrap)
            if loaded.wrap_type[k] in (self._mujoco.mjtWrap.mjWRAP_SPHERE, self._mujoco.mjtWrap.mjWRAP_CYLINDER)
        }
        shapes = tuple(self._shape(g) for g in sorted(wrapped) if loaded.geom_bodyid[g] == i)
        return Body(self._body_name(i), float(loaded.body_mass[i]), loaded.body_ipos[i].copy(), inertia, shapes)

    def _shape(self, i: int) -> Shape:
        loaded, geom = self._loaded, self._loaded.geom(i)
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_quat(loaded.geom_quat[i], scalar_first=True).as_matrix()
        pose[:3, 3] = loaded.geom_pos[i]
        radius, half = float(loaded.geom_size[i, 0]), float(loaded.geom_size[i, 1])
        if loaded.geom_type[i] == self._mujoco.mjtGeom.mjGEOM_SPHERE:
            return Shape(_name(geom, "geom"), "sphere", (radius,), pose)
        return Shape(_name(geom, "geom"), "cylinder", (radius, 2.0 * half), pose)


def _name(item: Any, what: str) -> str:
    return item.name or f"{what}{item.id}"


def _first_comment(file: Path) -> str:
    comment = re.search(r"<!--(.*?)-->", file.read_text(errors="replace")[:20_000], re.DOTALL)
    return comment[1].strip() if comment else ""
