"""CompiledSkeleton agrees with the plant from which it is derived: rates, gradients and simulations."""

import numpy as np
import pytest
from pydrake.autodiffutils import ExtractGradient, ExtractValue, InitializeAutoDiff
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drakearm.model import MakeTorqueArm
from drakearm.model.dynamics_table import read_dynamics
from drakearm.systems import CompiledSkeleton


@pytest.fixture(params=[0.0, 5.0], ids=["unloaded", "5 kg"])
def plant(arm, request):
    return MakeTorqueArm(arm, request.param)


def rates(system, port, state, torque):
    context = system.CreateDefaultContext()
    context.SetContinuousState(state)
    port.FixValue(context, torque)
    return system.EvalTimeDerivatives(context).CopyToVector()


def test_same_derivatives_as_the_plant(plant):
    skeleton = CompiledSkeleton(read_dynamics(plant))
    rng = np.random.default_rng(0)
    for _ in range(20):
        state, torque = rng.uniform(-3.0, 3.0, 4) * [1, 1, 3, 3], rng.uniform(-10.0, 10.0, 2)
        expected = rates(plant, plant.get_actuation_input_port(), state, torque)
        actual = rates(skeleton, skeleton.GetInputPort("torque"), state, torque)
        np.testing.assert_allclose(actual, expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("columns", [6, 13])
def test_same_gradients_as_the_plant(plant, columns):
    """The inputs may have any gradients: in a collocation, state and torque depend on 13 variables."""
    systems = plant.ToAutoDiffXd(), CompiledSkeleton(read_dynamics(plant)).ToAutoDiffXd()
    ports = systems[0].get_actuation_input_port(), systems[1].GetInputPort("torque")
    rng = np.random.default_rng(0)
    for _ in range(5):
        x = InitializeAutoDiff(rng.uniform(-3.0, 3.0, 6), rng.normal(size=(6, columns))).ravel()
        expected, actual = (rates(system, port, x[:4], x[4:]) for system, port in zip(systems, ports, strict=True))
        scale = np.abs(ExtractGradient(expected)).max()
        np.testing.assert_allclose(ExtractValue(actual), ExtractValue(expected), rtol=0.0, atol=1e-11 * scale)
        np.testing.assert_allclose(ExtractGradient(actual), ExtractGradient(expected), rtol=0.0, atol=1e-9 * scale)


def test_in_autodiff_it_also_takes_numbers_without_gradients(plant):
    skeleton = CompiledSkeleton(read_dynamics(plant))
    point = np.array([0.3, 1.2, -1.0, 2.0, 4.0, -1.0])
    constant = InitializeAutoDiff(point, np.zeros((6, 0))).ravel()
    differentiated = skeleton.ToAutoDiffXd()
    actual = rates(differentiated, differentiated.GetInputPort("torque"), constant[:4], constant[4:])
    expected = rates(skeleton, skeleton.GetInputPort("torque"), point[:4], point[4:])
    np.testing.assert_array_equal(ExtractValue(actual).ravel(), expected)


def simulate(system, port) -> np.ndarray:
    """The states (11, 4) during half a second of changing torques. The arm starts bent and in motion."""
    builder = DiagramBuilder()
    builder.AddSystem(system)
    torques = np.array([[0.0, 5.0, -3.0], [0.0, -2.0, 4.0]])
    source = builder.AddSystem(TrajectorySource(PiecewisePolynomial.FirstOrderHold([0.0, 0.25, 0.5], torques)))
    builder.Connect(source.get_output_port(), port)
    simulator = Simulator(builder.Build())
    ResetIntegratorFromFlags(simulator, "runge_kutta3", 0.01).set_target_accuracy(1e-9)
    context = system.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    context.SetContinuousState([-0.3, 1.4, 1.0, -2.0])
    states = []
    for time in np.linspace(0.0, 0.5, 11):
        simulator.AdvanceTo(time)
        states.append(context.get_continuous_state_vector().CopyToVector())
    return np.array(states)


def test_simulates_like_the_plant(plant):
    skeleton = CompiledSkeleton(read_dynamics(plant))
    expected = simulate(plant, plant.get_actuation_input_port())
    actual = simulate(skeleton, skeleton.GetInputPort("torque"))
    assert np.abs(np.diff(expected, axis=0)).max() > 0.1
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=1e-8)


def test_its_output_is_its_state(plant, outputs):
    skeleton = CompiledSkeleton(read_dynamics(plant))
    context = skeleton.CreateDefaultContext()
    state = context.get_continuous_state()
    assert (state.num_q(), state.num_v(), state.num_z()) == (2, 2, 0)
    context.SetContinuousState([0.1, 0.2, 0.3, 0.4])
    (arm_state,) = outputs(skeleton, {}, ["arm_state"], context)
    np.testing.assert_array_equal(arm_state, [0.1, 0.2, 0.3, 0.4])
    assert not skeleton.HasAnyDirectFeedthrough()
