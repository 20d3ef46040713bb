"""The skeleton, an arm's bodies and joints: puts it into a MultibodyPlant, gives its joint torques and its hand."""

import math

import numpy as np
from pydrake.geometry import Cylinder
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, MultibodyForces, RigidBody, SpatialInertia
from pydrake.systems.framework import Context

from drakearm.errors import ArmError
from drakearm.model.arm import Arm
from drakearm.model.skeleton_file import LOAD, check_skeleton, parse_skeleton

_IRON = 7870.0  # kg/m^3
_LOAD_COLOR = np.array([0.25, 0.27, 0.30, 1.0])
_GRIP, _BAR_RADIUS = 0.04, 0.009  # m, from the middle of a dumbbell to its discs, and of its bar


def load_inertia(mass: float) -> SpatialInertia:
    """The inertia of a load of this mass (kg), which is a ball of iron, about its center."""
    radius = _radius(mass)  # 0 also for a mass so small that it underflows
    return SpatialInertia.SolidSphereWithMass(mass, radius) if radius > 0.0 else SpatialInertia.Zero()


def _radius(mass: float) -> float:
    return (3.0 * mass / (4.0 * math.pi * _IRON)) ** (1.0 / 3.0)


def add_skeleton(
    plant: MultibodyPlant, arm: Arm, load_mass: float = 0.0, *, variable_load: bool = False
) -> ModelInstanceIndex:
    """Parses the arm's skeleton into a plant that is not finalized yet and sets the arm's gravity.

    load_mass: kg, of an iron ball that is centered on the arm's load frame and welded to it, as body "load"; it is
    drawn as a dumbbell. variable_load: whether the plant has this body even without a mass, so that a context can give
    it one. The plant has the skeleton's joint limits, but a continuous plant does not enforce them (see `JointStops`).
    Raises ArmError where the skeleton is damaged, lacks a joint, frame or body that the arm names, or cannot be moved
    by joint torques.
    """
    if not (math.isfinite(load_mass) and load_mass >= 0.0):
        raise ArmError(f"The load is {load_mass} kg: expected a mass that is not negative.")
    check_skeleton(arm)
    model = parse_skeleton(plant, arm.skeleton)
    plant.mutable_gravity_field().set_gravity_vector(np.array(arm.gravity))
    if load_mass > 0.0 or variable_load:
        load = plant.AddRigidBody(LOAD, model, load_inertia(load_mass))
        plant.WeldFrames(plant.GetFrameByName(arm.load_frame or arm.tip_frame, model), load.body_frame())
        if _radius(load_mass) > 0.0 and plant.geometry_source_is_registered():
            _draw_dumbbell(plant, load, load_mass)
    return model


def _draw_dumbbell(plant: MultibodyPlant, load: RigidBody, mass: float) -> None:
    """Two iron discs, with the mass together, on a bar along x, so that the hand between them stays visible."""
    radius = (mass / (math.pi * _IRON)) ** (1.0 / 3.0)  # of a disc that is half as thick
    parts = [("bar", 0.0, _BAR_RADIUS, 2.0 * _GRIP), ("front", _GRIP, radius, 0.5 * radius)]
    parts.append(("back", -_GRIP, radius, 0.5 * radius))
    along_x = RotationMatrix.MakeYRotation(0.5 * math.pi)
    for name, x, of, length in parts:
        at = x + math.copysign(0.5 * length, x) if x else 0.0
        plant.RegisterVisualGeometry(
            load, RigidTransform(along_x, [at, 0.0, 0.0]), Cylinder(of, length), f"{LOAD}_{name}", _LOAD_COLOR
        )


def skeleton_plant(arm: Arm, load_mass: float = 0.0) -> MultibodyPlant:
    """A finalized plant with the skeleton and a load (kg). Raises ArmError as `add_skeleton` does."""
    plant = MultibodyPlant(time_step=0.0)
    add_skeleton(plant, arm, load_mass)
    plant.Finalize()
    return plant


def position_ranges(plant: MultibodyPlant) -> tuple[np.ndarray, np.ndarray]:
    """The lower and upper limits (n_q,), rad, of the joints of a skeleton; -pi and pi where a joint has none."""
    lower, upper = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
    return np.where(np.isfinite(lower), lower, -np.pi), np.where(np.isfinite(upper), upper, np.pi)


def neutral_posture(plant: MultibodyPlant) -> np.ndarray:
    """The joint angles (n_q,), rad, that are 0, or as near to 0 as the ranges of the joints allow."""
    return np.clip(0.0, *position_ranges(plant))


def inverse_dynamics(plant: MultibodyPlant, context: Context, a: np.ndarray) -> np.ndarray:
    """The joint torques (n_q,), Nm, for the accelerations a (n_q,), rad/s^2, in the state of a plant's context."""
    forces = MultibodyForces(plant)
    plant.CalcForceElementsContribution(context, forces)
    return plant.CalcInverseDynamics(context, a, forces)


def movement_torques(plant: MultibodyPlant, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """The joint torques (N, n_q), Nm, of a movement: q, v, a, each (N, n_q), SI."""
    context = plant.CreateDefaultContext()
    torques = np.empty_like(q)
    for k in range(len(q)):
        plant.SetPositions(context, q[k])
        plant.SetVelocities(context, v[k])
        torques[k] = inverse_dynamics(plant, context, a[k])
    return torques


def hand_motion(plant: MultibodyPlant, arm: Arm, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The tip of the hand in the world: p_WH, m, and v_WH, m/s, each (N, 3), at q, rad, and v, rad/s, each (N, n_q)."""
    context, tip = plant.CreateDefaultContext(), plant.GetFrameByName(arm.tip_frame)
    p_WH, v_WH = np.empty((2, len(q), 3))
    for k in range(len(q)):
        plant.SetPositions(context, q[k])
        plant.SetVelocities(context, v[k])
        p_WH[k] = tip.CalcPoseInWorld(context).translation()
        v_WH[k] = tip.CalcSpatialVelocityInWorld(context).translational()
    return p_WH, v_WH


def gravity_torque(plant: MultibodyPlant, q: np.ndarray) -> np.ndarray:
    """The joint torques (n_q,), Nm, that hold the skeleton still at q (n_q,), rad."""
    rest = np.zeros((1, len(q)))
    return movement_torques(plant, q[None, :], rest, rest)[0]
