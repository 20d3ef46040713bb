"""Follows a planned movement with torque motors at the joints: feedforward torques plus a PD controller."""

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.controllers import PidController
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import Adder, LogVectorOutput, TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drakearm.experiments.scenario import load_scenario
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.planning import plan


def main() -> None:
    arm = load_arm("arm14")
    reference = plan(arm, load_scenario("timing-0.7s").movement).reference

    builder = DiagramBuilder()
    plant = builder.AddSystem(MakeTorqueArm(arm))
    desired = builder.AddSystem(TrajectorySource(reference.trajectory(), output_derivative_order=1))
    torques = builder.AddSystem(TrajectorySource(PiecewisePolynomial.FirstOrderHold(reference.t, reference.tau.T)))
    n = len(arm.coordinates)
    pd = builder.AddSystem(PidController(kp=np.full(n, 20.0), ki=np.zeros(n), kd=np.full(n, 2.0)))
    total = builder.AddSystem(Adder(2, n))
    builder.Connect(plant.get_state_output_port(), pd.get_input_port_estimated_state())
    builder.Connect(desired.get_output_port(), pd.get_input_port_desired_state())
    builder.Connect(torques.get_output_port(), total.get_input_port(0))
    builder.Connect(pd.get_output_port_control(), total.get_input_port(1))
    builder.Connect(total.get_output_port(), plant.get_actuation_input_port())
    log = LogVectorOutput(plant.get_state_output_port(), builder, 0.01)

    simulator = Simulator(builder.Build())
    plant.SetPositions(plant.GetMyMutableContextFromRoot(simulator.get_mutable_context()), reference.q[0])
    simulator.AdvanceTo(reference.duration)
    error = log.FindLog(simulator.get_context()).data()[:n].T - reference.q
    print(f"largest error {np.abs(error).max():.1e} rad")


if __name__ == "__main__":
    main()
