"""JointStops: no torque inside the range, resistance to outward motion, and no energy added."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.model.joint_stops import HARDENING, STOP_DAMPING, STOP_STIFFNESS, stop_torque
from drakearm.systems import JointStops

LOWER, UPPER = np.array([-1.5, 0.0]), np.array([3.1, 2.3])
STIFFNESS, DAMPING = np.full(2, STOP_STIFFNESS), np.full(2, STOP_DAMPING)
angles, speeds = st.floats(-4.0, 5.0), st.floats(-30.0, 30.0)


def torque(q, v):
    return stop_torque(np.array(q), np.array(v), LOWER, UPPER, STIFFNESS, DAMPING)


@settings(deadline=None)
@given(st.floats(-1.5, 3.1), st.floats(0.0, 2.3), speeds, speeds)
def test_no_torque_inside_the_range(q0, q1, v0, v1):
    assert (torque([q0, q1], [v0, v1]) == 0.0).all()


@settings(deadline=None)
@given(angles, angles, speeds, speeds)
def test_torque_points_into_the_range(q0, q1, v0, v1):
    tau = torque([q0, q1], [v0, v1])
    for i, q in enumerate((q0, q1)):
        assert tau[i] <= 0.0 if q > UPPER[i] else tau[i] >= 0.0 if q < LOWER[i] else tau[i] == 0.0


@settings(deadline=None)
@given(angles, angles, speeds, speeds)
def test_power_never_exceeds_that_of_the_spring(q0, q1, v0, v1):
    """The spring only releases energy that it has stored, so a stop never adds energy."""
    q, v = np.array([q0, q1]), np.array([v0, v1])
    depth = np.maximum(q - UPPER, 0.0) - np.maximum(LOWER - q, 0.0)
    spring = -STOP_STIFFNESS * depth * (1.0 + (depth / HARDENING) ** 2)
    assert (torque(q, v) * v <= np.maximum(spring * v, 0.0) + 1e-9).all()


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_output_port(outputs, time_step):
    stops = JointStops(LOWER, UPPER, time_step)
    context = stops.CreateDefaultContext()
    stops.GetInputPort("arm_state").FixValue(context, [0.0, 2.4, 0.0, 0.0])
    if time_step:
        context.SetDiscreteState(stops.EvalUniquePeriodicDiscreteUpdate(context).value())
    tau = stops.GetOutputPort("generalized_force").Eval(context)
    np.testing.assert_allclose(tau, [0.0, -STOP_STIFFNESS * 0.1 * (1.0 + (0.1 / HARDENING) ** 2)])


def test_arm_that_falls_onto_its_stop_is_held(arm):
    """The bent arm falls. Its elbow must not hyperextend by more than 5 degrees."""
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm, load_mass=2.0)
    builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
    diagram = builder.Build()
    simulator = MakeSimulator(diagram)
    context = simulator.get_mutable_context()
    diagram.GetInputPort("excitation").FixValue(context, np.zeros(14))
    muscle_arm.SetState(context, np.array([0.0, 2.0]))
    lowest = np.inf
    for k in range(150):
        simulator.AdvanceTo(0.01 * k)
        q = muscle_arm.plant.GetPositions(muscle_arm.plant.GetMyContextFromRoot(context))
        lowest = min(lowest, q[1])
    assert np.deg2rad(-5.0) < lowest
