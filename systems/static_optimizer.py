"""StaticOptimizer: a controller that follows a reference by static optimization, without learning."""

import numpy as np
from pydrake.systems.framework import Context, LeafSystem, State

from drakearm.model import Arm
from drakearm.model.feedback import Feedback
from drakearm.model.reference import CONTROL_STEP
from drakearm.model.skeleton import inverse_dynamics, skeleton_plant
from drakearm.model.static_optimization import acceleration_weighting, excitations_to_reach, static_activations

FEEDBACK = Feedback(stiffness=400.0, damping=40.0)


class StaticOptimizer(LeafSystem):
    """Decides excitations by static optimization at every control step and holds them in between.

    .. pydrake_system::

        name: StaticOptimizer
        input_ports:
        - arm_state
        - activation
        - reference
        output_ports:
        - excitation

    ========== ===== ==================== ====================================================
    port       size  unit                 meaning
    ========== ===== ==================== ====================================================
    arm_state  2 n_q rad, rad/s           q and v
    activation n     0..1                 of the muscles
    reference  3 n_q rad, rad/s, rad/s^2  desired q, v and a
    excitation n     0..1                 held for one control step; 0 before the first
    ========== ===== ==================== ====================================================

    This is computed muscle control (Thelen, Anderson and Delp 2003) without its prediction of the joint motion. One
    decision has four steps:

    1. `Feedback` gives the desired accelerations.
    2. Inverse dynamics, of a plant of its own with load_mass (kg) in the hand, gives the torques for them.
    3. `static_activations` gives the activations for these torques.
    4. `excitations_to_reach` gives the excitations that bring each activation there within a control step.

    Where the muscles are too weak, the joints miss their accelerations as little as possible. priority: (n_q,), from 0
    to 1, of each joint's error; by default all are alike.

    The method neglects that forces lag behind activations while tendons stretch. Therefore four times the default
    stiffness already makes the arm tremble.

    The decision is an unrestricted update. Drake makes such updates before the discrete updates of the same instant, so
    discrete muscles use a new excitation already in the step that begins when it is decided.
    """

    def __init__(
        self,
        arm: Arm,
        load_mass: float = 0.0,
        feedback: Feedback = FEEDBACK,
        control_step: float = CONTROL_STEP,
        priority: np.ndarray | None = None,
    ):
        super().__init__()
        self._muscles, self._paths = arm.muscle_table, arm.path_table
        self._feedback = feedback
        self._priority = np.ones(len(arm.coordinates)) if priority is None else priority
        self._control_step = control_step
        self._plant = skeleton_plant(arm, load_mass)
        self._plant_context = self._plant.CreateDefaultContext()
        n, n_q = len(arm.muscles), len(arm.coordinates)
        self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * n_q)
        self._activation = self.DeclareVectorInputPort("activation", n)
        self._reference = self.DeclareVectorInputPort("reference", 3 * n_q)
        self.DeclareStateOutputPort("excitation", self.DeclareDiscreteState(n))
        self.DeclarePeriodicUnrestrictedUpdateEvent(control_step, 0.0, self._decide)

    def _decide(self, context: Context, state: State) -> None:
        q, v = np.split(self._arm_state.Eval(context), 2)
        tau = self._torque(q, v, self._feedback.acceleration(q, v, self._reference.Eval(context)))
        activation = self._activation.Eval(context)
        desired, _ = static_activations(q, v, tau, activation, self._weighting(), self._muscles, self._paths)
        excitation = excitations_to_reach(desired, activation, self._control_step, self._muscles)
        state.get_mutable_discrete_state().set_value(excitation)

    def _weighting(self) -> np.ndarray:
        """The weighting of the torques that muscles lack, in the state for which `_torque` was called."""
        return acceleration_weighting(self._plant.CalcMassMatrix(self._plant_context), self._priority)

    def _torque(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Joint torques (n_q,), Nm, that accelerate the arm by a (n_q,), rad/s^2, at q and v."""
        plant, context = self._plant, self._plant_context
        plant.SetPositionsAndVelocities(context, np.concatenate([q, v]))
        return inverse_dynamics(plant, context, a)
