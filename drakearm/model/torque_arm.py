"""The skeleton with a motor at every joint, as a plant: the arm that optimal control plans for."""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.errors import ArmError
from drakearm.model.arm import Arm
from drakearm.model.skeleton import add_skeleton


def MakeTorqueArm(arm: Arm, load_mass: float = 0.0, torque_limit: np.ndarray | None = None) -> MultibodyPlant:
    """A continuous plant of the arm's skeleton, finalized, whose actuation port takes the joint torques (n_q,) in Nm.

    load_mass: kg, welded to the hand. torque_limit: (n_q,) Nm, at which the motors clamp; by default they do not.
    Raises ArmError where the skeleton's file has motors of its own.
    """
    plant = MultibodyPlant(time_step=0.0)
    add_skeleton(plant, arm, load_mass)
    if plant.num_actuators() > 0:
        raise ArmError(f"{arm.skeleton} has motors: expected none, because muscles move the arm.")
    limits = np.full(len(arm.coordinates), np.inf) if torque_limit is None else torque_limit
    for name, limit in zip(arm.coordinates, limits, strict=True):
        plant.AddJointActuator(name, plant.GetJointByName(name), float(limit))
    plant.Finalize()
    plant.set_name(f"{arm.name}_skeleton")
    return plant
