"""HillMuscles: the muscles of an arm as a System."""

import sys

import numpy as np
from pydrake.autodiffutils import AutoDiffXd, ExtractGradient, ExtractValue, InitializeAutoDiff
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    BasicVector_,
    Context,
    ContinuousState,
    DiscreteValues,
    EventStatus,
    LeafSystem_,
    State,
)
from pydrake.systems.scalar_conversion import TemplateSystem

from drakearm.errors import DerivativeError, StateError
from drakearm.model import Arm
from drakearm.model.equilibrium import neutral_state
from drakearm.model.linearization import linearize_muscles
from drakearm.model.musculature import (
    LARGEST_STATE,
    RESTING_ACTIVATION,
    muscle_geometry,
    muscle_rates,
    muscle_report,
    muscle_step,
    resting_state,
    tendon_forces,
)

_REPORT = ("active_force", "passive_force", "fiber_power", "tendon_power", "metabolic_power")


def _is_sound(arm_state: np.ndarray) -> bool:
    """Whether this can be the state of an arm. In a simulation that diverges, it grows without limit."""
    return bool((np.abs(arm_state) <= LARGEST_STATE).all())


@TemplateSystem.define("HillMuscles_", T_list=[float, AutoDiffXd], scope=sys.modules[__name__])
def HillMuscles_(T):
    class Impl(LeafSystem_[T]):
        """The muscles of an arm: excitations drive them, and they pull on the arm's joints.

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
            - joint_moment
            - active_force
            - passive_force
            - fiber_power
            - tendon_power
            - metabolic_power

        ================= ======= ==== =======================================================================
        port              size    unit meaning
        ================= ======= ==== =======================================================================
        excitation        n       0..1 neural command; clamped to [minimum_activation, 1]
        arm_state         2 n_q   SI   q and v of the skeleton, rad and rad/s
        generalized_force n_q     Nm   of the muscles on the joints
        activation        n       0..1 stays in [minimum_activation, 1]
        fiber_length      n       m
        fiber_velocity    n       m/s  negative while the fiber shortens
        tendon_force      n       N
        mtu_length        n       m    of the musculotendon path
        joint_moment      n n_q   Nm   of each muscle at each joint: element i n_q + j, muscle i, joint j
        active_force      n       N    of the contractile element, along the fiber
        passive_force     n       N    of the parallel element, along the fiber
        fiber_power       n       W    that the fiber delivers
        tendon_power      n       W    that the tendon delivers
        metabolic_power   n       W    heat and work, Bhargava et al. (2004)
        ================= ======= ==== =======================================================================

        The sum of fiber_power and tendon_power is -tendon_force d(mtu_length)/dt.

        The default state is rest with joint angles of 0, or as near to 0 as their ranges allow. Muscles start in
        equilibrium with the joints: if their state has not been set when a simulation is initialized, fibers and
        tendons are brought into equilibrium at arm_state. So it is enough to set the positions of the plant. Without a
        Simulator, call `SetEquilibrium`. Excitations that are not finite raise StateError, and so does an arm_state of
        a simulation that diverges.

        time_step = 0: activation and fiber length are continuous states, in this order, for any of Drake's integrators
        and for linearization. The system converts to AutoDiffXd, but joint_moment and the last five outputs do not
        exist there. Barely active fibers are stiff (rates up to 8e4 /s), so use continuous muscles for checks.

        time_step > 0 (s): the states are discrete. Each step is implicit and of second order (`muscle_step`), and it is
        stable at any activation. generalized_force is held constant during each step, so it has no direct feedthrough
        from arm_state. The other forces follow the joints within the step. Discrete muscles cannot step in AutoDiffXd.
        """

        def _construct(self, arm: Arm, time_step: float = 1e-3, *, converter=None):
            LeafSystem_[T].__init__(self, converter)
            self.arm = arm
            self.time_step = time_step
            # A parameter, because the strength of the muscles can differ from context to context.
            self._muscles = self.DeclareAbstractParameter(AbstractValue.Make(arm.muscle_table))
            n, n_q = len(arm.muscles), len(arm.coordinates)
            self._n, self._n_q = n, n_q
            self._default, tau = neutral_state(arm)

            self._excitation = self.DeclareVectorInputPort("excitation", n)
            self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * n_q)
            joints = {self._arm_state.ticket(), self.all_parameters_ticket()}
            if time_step > 0.0:
                state = {self.discrete_state_ticket(self.DeclareDiscreteState(self._default))}
                self.DeclareStateOutputPort("generalized_force", self.DeclareDiscreteState(tau))
                self.DeclarePeriodicDiscreteUpdateEvent(time_step, 0.0, self._step)
                velocity_from = state
            else:
                # Only this class overrides DoCalcTimeDerivatives. Discrete muscles have no continuous state, but Drake
                # would call their override at each of its evaluations, which takes time in Python.
                self.__class__ = Continuous
                self.DeclareContinuousState(BasicVector_[T](self._default[: 2 * n]))
                state = {self.xc_ticket()}
                self.DeclareVectorOutputPort("generalized_force", n_q, self._calc_generalized_force, state | joints)
                velocity_from = state | joints
            if T is float:
                self.DeclareInitializationUnrestrictedUpdateEvent(self._settle)
                if time_step == 0.0:
                    self.DeclarePerStepPublishEvent(self._require_sound_state)
            for name, size, calc, prerequisites in (
                ("activation", n, self._calc_activation, state),
                ("fiber_length", n, self._calc_fiber_length, state),
                ("fiber_velocity", n, self._calc_fiber_velocity, velocity_from),
                ("tendon_force", n, self._calc_tendon_force, state | joints),
                ("mtu_length", n, self._calc_mtu_length, joints),
                ("joint_moment", n * n_q, self._calc_joint_moment, state | joints),
            ):
                self.DeclareVectorOutputPort(name, size, calc, prerequisites)
            for row, name in enumerate(_REPORT):
                excitation = {self._excitation.ticket()} if name == "metabolic_power" else set()
                self.DeclareVectorOutputPort(name, n, self._make_calc_report(row, name), state | joints | excitation)

        def _construct_copy(self, other, converter=None):
            Impl._construct(self, other.arm, other.time_step, converter=converter)

        def SetEquilibrium(self, context: Context, q: np.ndarray, activation: float = RESTING_ACTIVATION):
            """Sets the muscles' state to rest at joint angles q (n_q,), rad, with one activation or (n,) activations.

            Activations from 0 to minimum_activation become the minimum, as excitations do. Raises EquilibriumError if a
            muscle has no equilibrium, and StateError for arrays of another size, for numbers that are not finite, and
            for activations outside of 0..1.
            """
            state, tau = resting_state(self.arm, np.asarray(q, dtype=float), activation)
            if self.time_step > 0.0:
                context.SetDiscreteState(0, state)
                context.SetDiscreteState(1, tau)
            else:
                context.SetContinuousState(state[: 2 * self._n])

        def SetStrength(self, context: Context, strength: float | np.ndarray):
            """Multiplies the arm's maximum isometric forces by strength, one factor or (n,).

            Tendons become as much stiffer as the muscles get stronger. Raises StateError unless all factors are
            positive and finite.
            """
            factors = np.broadcast_to(np.asarray(strength, dtype=float), self._n)
            if not (np.isfinite(factors) & (factors > 0.0)).all():
                raise StateError(f"The strength is {strength}: expected positive numbers.")
            muscles = self.arm.muscle_table.copy()
            muscles["max_isometric_force"] *= factors
            context.get_mutable_abstract_parameter(self._muscles).set_value(muscles)

        def GetStrength(self, context: Context) -> np.ndarray:
            """The factors (n,) of the arm's maximum isometric forces."""
            muscles = context.get_abstract_parameter(self._muscles).get_value()
            return muscles["max_isometric_force"] / self.arm.muscle_table["max_isometric_force"]

        def _tables(self, context: Context):
            """The tables of the muscles and of their paths that compiled functions take."""
            return context.get_abstract_parameter(self._muscles).get_value(), self.arm.path_table

        def _settle(self, context: Context, state: State) -> EventStatus:
            """Brings the muscles into equilibrium with the joints if they are still in their default state."""
            default = self._default if self.time_step > 0.0 else self._default[: 2 * self._n]
            if not np.array_equal(self._state(context), default):
                return EventStatus.DidNothing()
            q = self._arm_state.Eval(context)[: self._n_q]
            settled, tau = resting_state(self.arm, q, RESTING_ACTIVATION)
            if self.time_step > 0.0:
                state.get_mutable_discrete_state(0).set_value(settled)
                state.get_mutable_discrete_state(1).set_value(tau)
            else:
                state.get_mutable_continuous_state().SetFromVector(settled[: 2 * self._n])
            return EventStatus.Succeeded()

        def _require_sound_inputs(self, excitation: np.ndarray, arm_state: np.ndarray) -> None:
            if not np.isfinite(excitation).all():
                bad = [name for name, u in zip(self.arm.muscle_names, excitation, strict=True) if not np.isfinite(u)]
                raise StateError(f"The excitation of {', '.join(bad)} is not finite: expected numbers from 0 to 1.")
            if not _is_sound(arm_state):
                steps = "the time step" if self.time_step > 0.0 else "the steps of the integrator"
                raise StateError(
                    f"The motion of {self.arm.name} diverges: q or v has reached {np.abs(arm_state).max():.2g}. "
                    f"Its bodies are too light for its muscles, its joint stops or {steps}."
                )

        def _require_sound_state(self, context: Context) -> None:
            self._require_sound_inputs(np.zeros(self._n), self._arm_state.Eval(context))

        def GetStateNames(self) -> list[str]:
            """Names of the elements of the state, such as "BRA_fiber_length"; like MultibodyPlant.GetStateNames."""
            kinds = ["activation", "fiber_length"]
            if self.time_step > 0.0:
                kinds += ["previous_fiber_length", "fiber_velocity"]
            return [f"{name}_{kind}" for kind in kinds for name in self.arm.muscle_names]

        def _state(self, context):
            if self.time_step > 0.0:
                return context.get_discrete_state(0).value()
            return context.get_continuous_state_vector().CopyToVector()

        def _fibers(self, context):
            """Activations, then fiber lengths."""
            state = self._state(context)
            return state[: 2 * self._n] if self.time_step > 0.0 else state

        def _differentiate(self, context, fibers, excitation, arm_state, rows):
            """Rows of `linearize_muscles` as AutoDiffXd: gradient = its Jacobian times the gradients of the inputs."""
            inputs = [ExtractValue(x).ravel() for x in (fibers, excitation, arm_state)]
            value, jacobian = linearize_muscles(*inputs, *self._tables(context))
            gradient = ExtractGradient(np.concatenate([fibers, excitation, arm_state]))
            return InitializeAutoDiff(value[rows], jacobian[rows] @ gradient).ravel()

        def _differentiate_output(self, context, rows):
            """`_differentiate` for outputs that do not depend on the excitation."""
            no_excitation = np.array([AutoDiffXd(0.0)] * self._n)
            return self._differentiate(
                context, self._fibers(context), no_excitation, self._arm_state.Eval(context), rows
            )

        def _step(self, context: Context, state: DiscreteValues):
            if T is not float:
                raise DerivativeError("Discrete HillMuscles cannot step in AutoDiffXd: expected time_step = 0.")
            excitation = self._excitation.Eval(context)
            arm_state = self._arm_state.Eval(context)
            if not muscle_step(
                state.get_mutable_value(0),
                state.get_mutable_value(1),
                excitation,
                arm_state,
                self.time_step,
                *self._tables(context),
            ):
                self._require_sound_inputs(excitation, arm_state)

        def _calc_generalized_force(self, context: Context, output: BasicVector_[T]):
            if T is float:
                _, tau = tendon_forces(self._fibers(context), self._arm_state.Eval(context), *self._tables(context))
            else:
                tau = self._differentiate_output(context, slice(4 * self._n, None))
            output.SetFromVector(tau)

        def _calc_activation(self, context: Context, output: BasicVector_[T]):
            output.SetFromVector(self._state(context)[: self._n])

        def _calc_fiber_length(self, context: Context, output: BasicVector_[T]):
            output.SetFromVector(self._state(context)[self._n : 2 * self._n])

        def _calc_fiber_velocity(self, context: Context, output: BasicVector_[T]):
            output.SetFromVector(self._fiber_velocity(context))

        def _fiber_velocity(self, context):
            n = self._n
            if self.time_step > 0.0:
                return self._state(context)[3 * n :]
            if T is float:
                no_excitation = np.zeros(n)
                fibers, arm_state = self._fibers(context), self._arm_state.Eval(context)
                return muscle_rates(fibers, no_excitation, arm_state, *self._tables(context))[n:]
            return self._differentiate_output(context, slice(n, 2 * n))

        def _calc_tendon_force(self, context: Context, output: BasicVector_[T]):
            output.SetFromVector(self._tendon_force(context))

        def _tendon_force(self, context):
            if T is float:
                return tendon_forces(self._fibers(context), self._arm_state.Eval(context), *self._tables(context))[0]
            return self._differentiate_output(context, slice(2 * self._n, 3 * self._n))

        def _calc_mtu_length(self, context: Context, output: BasicVector_[T]):
            if T is float:
                length, _ = muscle_geometry(self._arm_state.Eval(context)[: self._n_q], *self._tables(context))
            else:
                length = self._differentiate_output(context, slice(3 * self._n, 4 * self._n))
            output.SetFromVector(length)

        def _calc_joint_moment(self, context: Context, output: BasicVector_[T]):
            self._require_float("joint_moment")
            _, moment_arm = muscle_geometry(self._arm_state.Eval(context)[: self._n_q], *self._tables(context))
            output.SetFromVector((moment_arm * self._tendon_force(context)[:, None]).ravel())

        def _make_calc_report(self, row, name):
            def calc(context: Context, output: BasicVector_[T]):
                self._require_float(name)
                metabolic = name == "metabolic_power"
                excitation = self._excitation.Eval(context) if metabolic else np.zeros(self._n)
                velocity, arm_state = self._fiber_velocity(context), self._arm_state.Eval(context)
                report = muscle_report(self._fibers(context), velocity, excitation, arm_state, *self._tables(context))
                output.SetFromVector(report[row])

            return calc

        def _require_float(self, name):
            if T is not float:
                raise DerivativeError(f"HillMuscles has no derivatives of its output {name}: expected doubles.")

    class Continuous(Impl):
        def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState):
            fibers, excitation = self._fibers(context), self._excitation.Eval(context)
            arm_state = self._arm_state.Eval(context)
            if T is float:
                # An integrator may try a step that is far too long, and reject it. Then it is no error.
                if _is_sound(arm_state):
                    self._require_sound_inputs(excitation, arm_state)
                rates = muscle_rates(fibers, excitation, arm_state, *self._tables(context))
            else:
                rates = self._differentiate(context, fibers, excitation, arm_state, slice(0, 2 * self._n))
            derivatives.SetFromVector(rates)

    return Impl
