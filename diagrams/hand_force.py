"""A force on the hand that depends on where the hand is and how it moves."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import BasicVector, Context, DiagramBuilder, LeafSystem, OutputPort

from drakearm.diagrams.muscle_arm import MuscleArm
from drakearm.diagrams.perturbation import Perturbation
from drakearm.errors import TaskError, shown

Force = Callable[[float, np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class HandForce(Perturbation):
    """A force on the tip of the hand, as of a robot that the hand holds.

    force: from the time, s, and the position and velocity of the tip in the world, each (3,), m and m/s, to the force
    on the hand in the world (3,), N. A curl field (Shadmehr and Mussa-Ivaldi 1994) is
    `lambda t, p, v: 13.0 * np.array([v[1], -v[0], 0.0])`. It is for Python only, because a file holds no function.
    """

    type = ""
    force: Force

    def perturb_torque(self, builder: DiagramBuilder, torque: OutputPort, arm: MuscleArm) -> OutputPort:
        added = builder.AddNamedSystem(f"hand_force_{len(builder.GetSystems())}", _HandTorque(arm, self.force))
        builder.Connect(torque, added.GetInputPort("torque"))
        builder.Connect(arm.plant.get_state_output_port(), added.GetInputPort("arm_state"))
        return added.GetOutputPort("total")


class _HandTorque(LeafSystem):
    """Adds the torques of a force on the hand to those on the joints: J^T F, J the Jacobian of the tip's velocity."""

    def __init__(self, arm: MuscleArm, force: Force):
        super().__init__()
        n_q = arm.plant.num_positions()
        self._plant, self._force = arm.plant, force
        self._plant_context = arm.plant.CreateDefaultContext()
        self._tip = arm.plant.GetFrameByName(arm.arm.tip_frame)
        self._torque = self.DeclareVectorInputPort("torque", n_q)
        self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * n_q)
        self.DeclareVectorOutputPort("total", n_q, self._calc_total)

    def _calc_total(self, context: Context, output: BasicVector) -> None:
        arm_state, world = self._arm_state.Eval(context), self._plant.world_frame()
        self._plant.SetPositionsAndVelocities(self._plant_context, arm_state)
        p_WH = self._tip.CalcPoseInWorld(self._plant_context).translation()
        J = self._plant.CalcJacobianTranslationalVelocity(
            self._plant_context, JacobianWrtVariable.kV, self._tip, np.zeros(3), world, world
        )
        v = arm_state[len(arm_state) // 2 :]
        force = np.asarray(self._force(context.get_time(), p_WH, J @ v), dtype=float)
        if force.shape != (3,) or not np.isfinite(force).all():
            raise TaskError(f"The force on the hand is {shown(force)} N: expected 3 finite numbers.")
        output.SetFromVector(self._torque.Eval(context) + J.T @ force)
