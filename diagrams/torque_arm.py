"""The skeleton with a motor at every joint: what optimal control plans on."""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drakearm.errors import ArmError
from drakearm.model import Arm
from drakearm.model.skeleton import add_skeleton


def MakeTorqueArm(arm: Arm, load_mass: float = 0.0, torque_limit: np.ndarray | None = None) -> MultibodyPlant:
    """A continuous plant of the arm's skeleton, finalized, whose actuation port takes the joint torques (n_q,) in Nm.

    load_mass: kg, welded to the hand. torque_limit: (n_q,) Nm, where the motors clamp; by default nowhere.
    """
    plant = MultibodyPlant(time_step=0.0)
    add_skeleton(plant, arm, load_mass)
    if plant.num_actuators() > 0:
        raise ArmError(f"{arm.skeleton} has motors: expected none, because the muscles move the arm.")
    limits = np.full(len(arm.coordinates), np.inf) if torque_limit is None else torque_limit
    for name, limit in zip(arm.coordinates, limits, strict=True):
        plant.AddJointActuator(name, plant.GetJointByName(name), float(limit))
    plant.Finalize()
    plant.set_name(f"{arm.name}_skeleton")
    return plant
