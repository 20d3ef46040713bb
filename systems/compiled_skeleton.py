"""CompiledSkeleton: the skeleton's dynamics as a System that can be differentiated quickly."""

import sys

import numpy as np
from pydrake.autodiffutils import AutoDiffXd, ExtractGradient, ExtractValue, InitializeAutoDiff
from pydrake.systems.framework import Context, ContinuousState, LeafSystem_
from pydrake.systems.scalar_conversion import TemplateSystem

from drakearm.model.dynamics import forward_dynamics
from drakearm.model.dynamics_jacobian import linearize_dynamics
from drakearm.model.dynamics_table import DynamicsTable


@TemplateSystem.define("CompiledSkeleton_", T_list=[float, AutoDiffXd], scope=sys.modules[__name__])
def CompiledSkeleton_(T):
    class Impl(LeafSystem_[T]):
        """A tree of revolute joints driven by torques: the equations of a MultibodyPlant, compiled, for planning.

        .. pydrake_system::

            name: CompiledSkeleton
            input_ports:
            - torque
            output_ports:
            - arm_state

        ================= ====== =========== ====================
        port              size   unit        meaning
        ================= ====== =========== ====================
        torque            n_q    Nm          torques on the joints
        arm_state         2 n_q  rad, rad/s  q and v
        ================= ====== =========== ====================

        dynamics: the equations of motion that `read_dynamics(plant)` derives, without joint limits and damping. The
        continuous state is q and v. In AutoDiffXd one compiled call gives the accelerations and their Jacobian. A
        MultibodyPlant carries the derivatives through all of its arithmetic, which takes longer.
        """

        def _construct(self, dynamics: DynamicsTable, *, converter=None):
            LeafSystem_[T].__init__(self, converter)
            self.dynamics = dynamics
            self._n_q = n_q = dynamics.mass_basis.shape[1]
            self._torque = self.DeclareVectorInputPort("torque", n_q)
            self.DeclareStateOutputPort("arm_state", self.DeclareContinuousState(n_q, n_q, 0))

        def _construct_copy(self, other, converter=None):
            Impl._construct(self, other.dynamics, converter=converter)

        def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState):
            n_q = self._n_q
            arm_state, tau = context.get_continuous_state_vector().CopyToVector(), self._torque.Eval(context)
            if T is float:
                a = forward_dynamics(arm_state[:n_q], arm_state[n_q:], tau, self.dynamics)
            else:
                point = np.concatenate([arm_state, tau])
                value = ExtractValue(point).ravel()
                a, jacobian = linearize_dynamics(value[:n_q], value[n_q:-n_q], value[-n_q:], self.dynamics)
                a = InitializeAutoDiff(a, jacobian @ ExtractGradient(point)).ravel()
            derivatives.SetFromVector(np.concatenate([arm_state[n_q:], a]))

    return Impl
