"""HillMuscles: the muscles of an arm as a System."""

import numpy as np
from pydrake.systems.framework import (
    BasicVector_,
    Context,
    ContinuousState,
    DiscreteValues,
    LeafSystem_,
)
from pydrake.systems.scalar_conversion import TemplateSystem

from drakearm.model import Arm
from drakearm.model.musculature import (
    muscle_geometry,
    muscle_rates,
    muscle_step,
    resting_state,
    tendon_forces,
)

RESTING_ACTIVATION = 0.05


@TemplateSystem.define("HillMuscles_", T_list=[float])
def HillMuscles_(T):
    class Impl(LeafSystem_[T]):
        """The muscles of an arm, driven by excitations, pulling on the arm's joints.

        .. pydrake_system::

            name: HillMuscles
            input_ports:
            - excitation
            - arm_state
            output_ports:
            - generalized_force
            - activation
            - fiber_length
            - fiber_velocity
            - tendon_force
            - mtu_length

        ================= ====== ======= ================================================================
        port              size   unit    meaning
        ================= ====== ======= ================================================================
        excitation        n      0..1    neural command; clamped to [minimum_activation, 1]
        arm_state         2 n_q  rad,    q and v of the skeleton
                                 rad/s
        generalized_force n_q    Nm      what the muscles exert at the joints
        activation        n      0..1
        fiber_length      n      m
        fiber_velocity    n      m/s     negative while the fiber shortens
        tendon_force      n      N
        mtu_length        n      m       of the musculotendon path
        ================= ====== ======= ================================================================

        time_step = 0: activation and fiber length are continuous states, for any of Drake's integrators. Barely active
        fibers are stiff (to 8e4 /s), so that is the way of checks and linearizations.

        time_step > 0 (s): the states are discrete. Each step is implicit and of second order (`fiber_step`), stable at
        any activation. Then generalized_force is held constant over a step and does not feed arm_state through, while
        tendon_force and mtu_length follow the joints.
        """

        def _construct(self, arm: Arm, time_step: float = 1e-3, *, converter=None):
            LeafSystem_[T].__init__(self, converter)
            self.arm = arm
            self.time_step = time_step
            self._tables = (arm.muscle_table, arm.path_table)
            n, n_q = len(arm.muscles), len(arm.coordinates)
            self._n, self._n_q = n, n_q
            resting, tau = resting_state(arm, np.zeros(n_q), RESTING_ACTIVATION)

            self._excitation = self.DeclareVectorInputPort("excitation", n)
            self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * n_q)
            joints = {self._arm_state.ticket()}
            if time_step > 0.0:
                state = {self.discrete_state_ticket(self.DeclareDiscreteState(resting))}
                self.DeclareStateOutputPort("generalized_force", self.DeclareDiscreteState(tau))
                self.DeclarePeriodicDiscreteUpdateEvent(time_step, 0.0, self._step)
                velocity_from = state
            else:
                self.DeclareContinuousState(BasicVector_[T](resting[: 2 * n]))
                state = {self.xc_ticket()}
                self.DeclareVectorOutputPort("generalized_force", n_q, self._calc_generalized_force, state | joints)
                velocity_from = state | joints
            for name, calc, prerequisites in (
                ("activation", self._calc_activation, state),
                ("fiber_length", self._calc_fiber_length, state),
                ("fiber_velocity", self._calc_fiber_velocity, velocity_from),
                ("tendon_force", self._calc_tendon_force, state | joints),
                ("mtu_length", self._calc_mtu_length, joints),
            ):
                self.DeclareVectorOutputPort(name, n, calc, prerequisites)

        def _construct_copy(self, other, converter=None):
            Impl._construct(self, other.arm, other.time_step, converter=converter)

        def SetEquilibrium(self, context: Context, q: np.ndarray, activation: float = RESTING_ACTIVATION):
            """Sets the muscles' state to rest at joint angles q (n_q,), rad, with one activation or (n,) activations.

            Raises EquilibriumError where a muscle has no equilibrium.
            """
            state, tau = resting_state(self.arm, np.asarray(q, dtype=float), activation)
            if self.time_step > 0.0:
                context.SetDiscreteState(0, state)
                context.SetDiscreteState(1, tau)
            else:
                context.SetContinuousState(state[: 2 * self._n])

        def _state(self, context):
            if self.time_step > 0.0:
                return context.get_discrete_state(0).value()
            return context.get_continuous_state_vector().CopyToVector()

        def _fibers(self, context):
            state = self._state(context)
            return state[: self._n], state[self._n : 2 * self._n]

        def _q(self, context):
            return self._arm_state.Eval(context)[: self._n_q]

        def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState):
            if self.time_step > 0.0:
                return
            excitation = self._excitation.Eval(context)
            rates = muscle_rates(*self._fibers(context), excitation, self._q(context), *self._tables)
            derivatives.SetFromVector(np.concatenate(rates))

        def _step(self, context: Context, state: DiscreteValues):
            muscle_step(
                state.get_mutable_value(0),
                state.get_mutable_value(1),
                self._excitation.Eval(context),
                self._arm_state.Eval(context),
                self.time_step,
                *self._tables,
            )

        def _calc_generalized_force(self, context: Context, output: BasicVector_[T]):
            _, fiber_length = self._fibers(context)
            output.SetFromVector(tendon_forces(fiber_length, self._q(context), *self._tables)[1])

        def _calc_activation(self, context: Context, output: BasicVector_[T]):
            output.SetFromVector(self._fibers(context)[0])

        def _calc_fiber_length(self, context: Context, output: BasicVector_[T]):
            output.SetFromVector(self._fibers(context)[1])

        def _calc_fiber_velocity(self, context: Context, output: BasicVector_[T]):
            if self.time_step > 0.0:
                output.SetFromVector(self._state(context)[3 * self._n :])
            else:
                activation, fiber_length = self._fibers(context)
                rates = muscle_rates(activation, fiber_length, activation, self._q(context), *self._tables)
                output.SetFromVector(rates[1])

        def _calc_tendon_force(self, context: Context, output: BasicVector_[T]):
            _, fiber_length = self._fibers(context)
            output.SetFromVector(tendon_forces(fiber_length, self._q(context), *self._tables)[0])

        def _calc_mtu_length(self, context: Context, output: BasicVector_[T]):
            output.SetFromVector(muscle_geometry(self._q(context), *self._tables)[0])

    return Impl


HillMuscles = HillMuscles_[None]
