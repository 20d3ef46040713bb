"""HillMuscles: ports, outputs at rest, both kinds of state, statics against OpenSim, and whole simulations."""

import re
from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.errors import EquilibriumError, StateError
from drakearm.model.musculature import RESTING_ACTIVATION, equilibrium_fiber_lengths, muscle_geometry
from drakearm.systems import HillMuscles

N = 14
NAMES = ["generalized_force", "activation", "fiber_length", "fiber_velocity", "tendon_force", "mtu_length"]


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_ports_have_names_and_sizes(arm, time_step):
    muscles = HillMuscles(arm, time_step)
    assert muscles.GetInputPort("excitation").size() == N
    assert muscles.GetInputPort("arm_state").size() == 4
    assert [muscles.GetOutputPort(name).size() for name in NAMES] == [2, N, N, N, N, N]


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_states_have_names(arm, time_step):
    muscles = HillMuscles(arm, time_step)
    context = muscles.CreateDefaultContext()
    muscles.SetEquilibrium(context, np.array([0.0, 1.0]), np.linspace(0.1, 0.9, N))
    state = context.get_discrete_state(0).value() if time_step else context.get_continuous_state_vector().CopyToVector()
    named = dict(zip(muscles.GetStateNames(), state, strict=True))
    assert named["TRIlong_activation"] == pytest.approx(0.1)
    assert named["PL_activation"] == pytest.approx(0.9)
    assert named["BRA_fiber_length"] == muscles.GetOutputPort("fiber_length").Eval(context)[5]


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_equilibrium_pulls_with_moment_arm_times_tendon_force(arm, outputs, time_step):
    muscles = HillMuscles(arm, time_step)
    context = muscles.CreateDefaultContext()
    q = np.array([0.2, 1.2])
    muscles.SetEquilibrium(context, q, 0.3)
    inputs = {"excitation": np.full(N, 0.3), "arm_state": [*q, 0.0, 0.0]}
    tau, activation, fiber, velocity, force, length = outputs(muscles, inputs, NAMES, context)
    expected_length, moment_arm = muscle_geometry(q, arm.muscle_table, arm.path_table)
    np.testing.assert_array_equal(activation, 0.3)
    np.testing.assert_array_equal(fiber, equilibrium_fiber_lengths(arm, q[None, :], np.full(N, 0.3))[0])
    np.testing.assert_allclose(velocity, 0.0, atol=1e-9)
    np.testing.assert_array_equal(length, expected_length)
    np.testing.assert_allclose(tau, moment_arm.T @ force, atol=1e-12)


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_rest_stays_at_rest(arm, time_step):
    """Nothing changes if the excitations equal the activations and the joints do not move."""
    builder = DiagramBuilder()
    muscles = builder.AddSystem(HillMuscles(arm, time_step))
    for name, value in (("excitation", np.full(N, 0.2)), ("arm_state", np.array([0.1, 0.9, 0.0, 0.0]))):
        source = builder.AddSystem(ConstantVectorSource(value))
        builder.Connect(source.get_output_port(), muscles.GetInputPort(name))
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = muscles.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    muscles.SetEquilibrium(context, np.array([0.1, 0.9]), 0.2)
    before = [muscles.GetOutputPort(name).Eval(context) for name in NAMES]
    simulator.AdvanceTo(0.02)
    for name, value in zip(NAMES, before, strict=True):
        np.testing.assert_allclose(muscles.GetOutputPort(name).Eval(context), value, atol=1e-6)


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_an_activation_below_the_minimum_becomes_the_minimum(arm, time_step):
    muscles = HillMuscles(arm, time_step)
    context, least = muscles.CreateDefaultContext(), muscles.CreateDefaultContext()
    q = np.array([0.0, 1.0])
    muscles.SetEquilibrium(context, q, np.linspace(0.0, 1.0 + 1e-9, N))
    muscles.SetEquilibrium(least, q, np.maximum(np.linspace(0.0, 1.0, N), arm.muscle_table["minimum_activation"]))
    for name in ("activation", "fiber_length"):
        values = [muscles.GetOutputPort(name).Eval(each) for each in (context, least)]
        np.testing.assert_allclose(*values, rtol=1e-8)
        assert values[0].max() <= 1.0


def test_posture_without_equilibrium_is_an_error_that_names_the_muscles(arm):
    muscles = HillMuscles(arm)
    with pytest.raises(EquilibriumError, match="BIClong"):
        muscles.SetEquilibrium(muscles.CreateDefaultContext(), np.array([5.0, 5.0]))


@pytest.mark.parametrize("model", ["thelen2003", "degroote2016"])
@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_outputs_are_finite_far_outside_the_range_of_the_joints(arm, outputs, time_step, model):
    muscles = HillMuscles(replace(arm, muscles=tuple(replace(m, model=model) for m in arm.muscles)), time_step)
    context = muscles.CreateDefaultContext()
    muscles.SetEquilibrium(context, np.array([0.1, 0.9]))
    names = [*NAMES, "metabolic_power", "joint_moment"]
    for angle in (-1000.0, -5.0, 5.0, 1000.0):
        inputs = {"excitation": np.full(N, 0.2), "arm_state": [angle, angle, 1e3, -1e3]}
        for values in outputs(muscles, inputs, names, context):
            assert np.isfinite(values).all()
        if not time_step:
            assert np.isfinite(muscles.EvalTimeDerivatives(context).CopyToVector()).all()


def test_an_arm_need_not_have_an_equilibrium_with_its_joints_at_0(arm):
    """Its joints may never be there. The default state is replaced when a simulation starts."""
    muscles = tuple(
        replace(m, tendon_slack_length=1.6 * m.tendon_slack_length) if m.name == "BIClong" else m for m in arm.muscles
    )
    muscles = HillMuscles(replace(arm, muscles=muscles))
    context = muscles.CreateDefaultContext()
    with pytest.raises(EquilibriumError, match="BIClong"):
        muscles.SetEquilibrium(context, np.array([0.0, 0.0]))
    muscles.SetEquilibrium(context, np.array([-1.5, 0.0]))


@pytest.mark.parametrize("time_step", [0.0, 1e-3])
def test_the_default_state_is_rest_in_a_posture_of_the_arms_range(arm, tmp_path, time_step):
    """A shoulder that turns from 0.3 to 1.5 rad, and an elbow that turns from 0: nearest to 0 are 0.3 and 0."""
    urdf = arm.skeleton.read_text()
    assert '<limit lower="-1.57079633" upper="3.14159265"' in urdf
    (tmp_path / "skeleton.urdf").write_text(
        urdf.replace('<limit lower="-1.57079633" upper="3.14159265"', '<limit lower="0.3" upper="1.5"')
    )
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, replace(arm, skeleton=tmp_path / "skeleton.urdf"), time_step=time_step)
    builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
    context = builder.Build().CreateDefaultContext()
    np.testing.assert_allclose(muscle_arm.plant.GetPositions(muscle_arm.plant.GetMyContextFromRoot(context)), [0.3, 0])
    muscles = muscle_arm.muscles.GetMyContextFromRoot(context)
    fibers = muscle_arm.muscles.GetOutputPort("fiber_length").Eval(muscles)
    expected = equilibrium_fiber_lengths(arm, np.array([[0.3, 0.0]]), np.full(N, RESTING_ACTIVATION))[0]
    np.testing.assert_array_equal(fibers, expected)


def test_a_motion_that_diverges_is_an_error(arm, tmp_path):
    """A thousandth of the masses is too light for the muscles and stops, at this time step."""
    urdf = re.sub(
        r'(mass value|ixx|iyy|izz|ixy|ixz|iyz)="(.*?)"',
        lambda m: f'{m[1]}="{1e-6 * float(m[2])}"',
        arm.skeleton.read_text(),
    )
    (tmp_path / "skeleton.urdf").write_text(urdf)
    with pytest.raises(StateError, match="motion of arm14 diverges"):
        simulate(replace(arm, skeleton=tmp_path / "skeleton.urdf"), 1e-3, np.full(N, 1.0), np.array([0.1, 0.6]), 0.3)


def simulate(arm, time_step, excitation, q, duration):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm, time_step=time_step)
    source = builder.AddSystem(ConstantVectorSource(excitation))
    builder.Connect(source.get_output_port(), muscle_arm.muscles.GetInputPort("excitation"))
    diagram = builder.Build()
    simulator = MakeSimulator(diagram, time_step) if time_step else Simulator(diagram)
    if not time_step:
        simulator.get_mutable_integrator().set_target_accuracy(1e-8)
    context = simulator.get_mutable_context()
    muscle_arm.SetState(context, q)
    simulator.AdvanceTo(duration)
    return muscle_arm.plant.GetPositions(muscle_arm.plant.GetMyContextFromRoot(context))


def test_error_of_discrete_muscles_falls_with_the_square_of_the_step(arm):
    excitation = np.full(N, 0.05)
    excitation[[3, 4, 5]] = 0.4  # not long enough to reach a stop
    q = np.array([0.1, 0.6])
    exact = simulate(arm, 0.0, excitation, q, 0.15)
    coarse, fine = (np.abs(simulate(arm, h, excitation, q, 0.15) - exact).max() for h in (2e-3, 1e-3))
    print(f"error in rad after 0.15 s: {coarse:.1e} at 2 ms, {fine:.1e} at 1 ms")
    assert fine < 2e-3
    assert 2.5 < coarse / fine < 6.0


def test_statics_against_opensim(arm, outputs, oracle):
    """In 40 postures the tendon forces are those of OpenSim, where the spline path has the same length."""
    statics = oracle("statics.npz")
    muscles = HillMuscles(arm, 0.0)
    context = muscles.CreateDefaultContext()
    for k, q in enumerate(statics["q"][:40]):
        activation, fiber = statics["activation"][k], statics["fibre_length"][k]
        context.SetContinuousState(np.concatenate([activation, fiber]))
        inputs = {"excitation": activation, "arm_state": [*q, 0.0, 0.0]}
        force, length = outputs(muscles, inputs, ["tendon_force", "mtu_length"], context)
        same = np.abs(length - statics["mtu_length"][k]) < 1e-5
        difference = np.abs(force - statics["tendon_force"][k])[same] / arm.muscle_table["max_isometric_force"][same]
        assert (difference < 0.02).all()  # 1e-5 m of path change the force of the stiffest tendon by 0.7 % of F_max
