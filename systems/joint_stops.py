"""JointStops: springs and dampers that keep joints inside their range."""

import sys

import numpy as np
from pydrake.autodiffutils import AutoDiffXd
from pydrake.systems.framework import BasicVector_, Context, DiscreteValues, LeafSystem_
from pydrake.systems.scalar_conversion import TemplateSystem

from drakearm.errors import DerivativeError
from drakearm.model.joint_stops import (
    STOP_DAMPING,
    STOP_STIFFNESS,
    held_stop_torque,
    joint_stop_torque,
    stop_torque,
)


@TemplateSystem.define("JointStops_", T_list=[float, AutoDiffXd], scope=sys.modules[__name__])
def JointStops_(T):
    class Impl(LeafSystem_[T]):
        """Springs and dampers that act on joints only beyond the ends of their range (`joint_stop_torque`).

        .. pydrake_system::

            name: JointStops
            input_ports:
            - arm_state
            output_ports:
            - generalized_force

        ================= ====== =========== =====================================
        port              size   unit        meaning
        ================= ====== =========== =====================================
        arm_state         2 n_q  rad, rad/s  q and v of the skeleton
        generalized_force n_q    Nm          of the stops on the joints
        ================= ====== =========== =====================================

        lower, upper: ends of the range (n_q,), rad; an infinite end has no stop. stiffness: Nm/rad, damping:
        Nm s/rad, one number or (n_q,); see `stop_strength` for light limbs.
        time_step = 0: the torque follows arm_state continuously. time_step > 0 (s): every step computes the torque for
        the joint state that is expected at the middle of the step, and holds it during the step.
        """

        def _construct(
            self,
            lower: np.ndarray,
            upper: np.ndarray,
            time_step: float = 1e-3,
            stiffness: float | np.ndarray = STOP_STIFFNESS,
            damping: float | np.ndarray = STOP_DAMPING,
            *,
            converter=None,
        ):
            LeafSystem_[T].__init__(self, converter)
            self.lower, self.upper = np.array(lower, dtype=float), np.array(upper, dtype=float)
            self.time_step = time_step
            n_q = len(self.lower)
            self.stiffness, self.damping = (np.full(n_q, strength, dtype=float) for strength in (stiffness, damping))
            self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * n_q)
            if time_step > 0.0:
                self.DeclareStateOutputPort("generalized_force", self.DeclareDiscreteState(n_q))
                self.DeclarePeriodicDiscreteUpdateEvent(time_step, 0.0, self._step)
            else:
                self.DeclareVectorOutputPort(
                    "generalized_force", n_q, self._calc_generalized_force, {self._arm_state.ticket()}
                )

        def _construct_copy(self, other, converter=None):
            Impl._construct(
                self,
                other.lower,
                other.upper,
                other.time_step,
                other.stiffness,
                other.damping,
                converter=converter,
            )

        def _step(self, context: Context, state: DiscreteValues):
            if T is not float:
                raise DerivativeError("Discrete JointStops cannot step in AutoDiffXd: expected time_step = 0.")
            tau, arm_state = state.get_mutable_value(0), self._arm_state.Eval(context)
            limits = (self.lower, self.upper, self.stiffness, self.damping)
            held_stop_torque(tau, arm_state, self.time_step, *limits)

        def _calc_generalized_force(self, context: Context, output: BasicVector_[T]):
            arm_state, n_q = self._arm_state.Eval(context), len(self.lower)
            q, v = arm_state[:n_q], arm_state[n_q:]
            if T is float:
                tau = stop_torque(q, v, self.lower, self.upper, self.stiffness, self.damping)
            else:
                joints = zip(q, v, self.lower, self.upper, self.stiffness, self.damping, strict=True)
                torques = [joint_stop_torque.py_func(*joint) for joint in joints]
                tau = np.array([AutoDiffXd(0.0) + torque for torque in torques])
            output.SetFromVector(tau)

    return Impl
