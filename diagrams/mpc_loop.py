"""Model predictive control in closed loop: an arm with motors at its joints, and a controller that plans repeatedly."""

from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import LogVectorOutput, TrajectorySource, VectorLogSink
from pydrake.trajectories import Trajectory

from drakearm.model import Arm, MakeTorqueArm
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.systems.collocation_mpc import CollocationMpc, Planner

_ACCURACY = 1e-6  # relative, of the integrator


@dataclass(frozen=True)
class MpcLoop:
    """A closed-loop Diagram, its systems and its logs, which have one sample per control step."""

    diagram: Diagram
    plant: MultibodyPlant
    controller: CollocationMpc
    logs: dict[str, VectorLogSink]

    def Run(self, q: np.ndarray, duration: float) -> Reference:
        """Simulates a duration (s) from rest at q (n_q,), rad, and returns the arm's movement.

        Raises PlanningError if the controller finds no plan.
        """
        simulator = Simulator(self.diagram)
        ResetIntegratorFromFlags(simulator, "runge_kutta3", CONTROL_STEP).set_target_accuracy(_ACCURACY)
        context = simulator.get_mutable_context()
        self.plant.SetPositions(self.plant.GetMyMutableContextFromRoot(context), q)
        simulator.Initialize()
        simulator.AdvanceTo(duration)
        logs = {name: log.FindLog(context) for name, log in self.logs.items()}
        q_and_v = logs["arm_state"].data().T
        n_q = q_and_v.shape[1] // 2
        return Reference(
            t=logs["arm_state"].sample_times().copy(),
            q=q_and_v[:, :n_q].copy(),
            v=q_and_v[:, n_q:].copy(),
            a=logs["acceleration"].data().T.copy(),
            tau=logs["torque"].data().T.copy(),
        )


def MakeMpcLoop(arm: Arm, planner: Planner, load_mass: float = 0.0, disturbance: Trajectory | None = None) -> MpcLoop:
    """The torque-driven arm, controlled by `CollocationMpc`.

    planner: see `CollocationMpc`. load_mass: kg, in the hand. disturbance: additional torques (n_q,), Nm, on the joints
    over time, which the planner does not know.
    """
    builder = DiagramBuilder()
    plant = builder.AddNamedSystem("plant", MakeTorqueArm(arm, load_mass))
    controller = builder.AddNamedSystem("mpc", CollocationMpc(planner, len(arm.coordinates)))
    torque = controller.GetOutputPort("torque")
    builder.Connect(plant.get_state_output_port(), controller.GetInputPort("arm_state"))
    builder.Connect(torque, plant.get_actuation_input_port())
    if disturbance is not None:
        source = builder.AddNamedSystem("disturbance", TrajectorySource(disturbance))
        builder.Connect(source.get_output_port(), plant.get_applied_generalized_force_input_port())
    ports = {
        "arm_state": plant.get_state_output_port(),
        "acceleration": plant.get_generalized_acceleration_output_port(),
        "torque": torque,
    }
    logs = {name: LogVectorOutput(port, builder, CONTROL_STEP) for name, port in ports.items()}
    diagram = builder.Build()
    diagram.set_name("mpc_loop")
    return MpcLoop(diagram, plant, controller, logs)
