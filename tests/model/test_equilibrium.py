"""Equilibria: nothing moves, postures that cannot be held are refused, and Drake can linearize there."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import Linearize

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.errors import EquilibriumError, StateError
from drakearm.model import find_equilibrium
from drakearm.model.weakness import weakness

POSTURES = np.deg2rad([[-20.0, 80.0], [0.0, 30.0], [-40.0, 5.0]])


def make_arm(arm, time_step, load_mass=0.0):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm, load_mass=load_mass, time_step=time_step, stops=time_step > 0.0)
    builder.ExportInput(muscle_arm.muscles.GetInputPort("excitation"), "excitation")
    return builder.Build(), muscle_arm


@pytest.mark.parametrize("q", POSTURES)
@pytest.mark.parametrize("load_mass", [0.0, 1.0])
def test_muscles_exert_the_torque_of_gravity_and_the_arm_rests(arm, q, load_mass):
    equilibrium = find_equilibrium(arm, q, load_mass)
    assert np.all((equilibrium.excitation >= arm.muscle_table["minimum_activation"]) & (equilibrium.excitation <= 1.0))
    diagram, muscle_arm = make_arm(arm, 1e-3, load_mass)
    simulator = MakeSimulator(diagram)
    context = simulator.get_mutable_context()
    held = muscle_arm.SetEquilibrium(context, q)
    np.testing.assert_array_equal(held.excitation, equilibrium.excitation)
    diagram.GetInputPort("excitation").FixValue(context, held.excitation)
    simulator.AdvanceTo(0.3)
    state = muscle_arm.plant.GetPositionsAndVelocities(muscle_arm.plant.GetMyContextFromRoot(context))
    np.testing.assert_allclose(state, [*q, 0.0, 0.0], atol=1e-7)


def test_drake_linearizes_at_an_equilibrium(arm):
    """The linear system has the Diagram's derivatives for a small change of the state.

    The muscles have smooth curves, because the force-velocity curve of Thelen (2003) has a corner at rest.
    """
    arm = replace(arm, muscles=tuple(replace(muscle, model="degroote2016") for muscle in arm.muscles))
    diagram, muscle_arm = make_arm(arm, 0.0)
    context = diagram.CreateDefaultContext()
    held = muscle_arm.SetEquilibrium(context, POSTURES[0])
    diagram.GetInputPort("excitation").FixValue(context, held.excitation)
    x = context.get_continuous_state_vector().CopyToVector()
    linear = Linearize(diagram, context)
    assert linear.A().shape == (len(x), len(x)) and np.isfinite(linear.A()).all()
    change = 1e-8 * np.random.default_rng(0).standard_normal(len(x))
    change[4:18] = 0.0  # activations: at their minimum the rates have different derivatives on the two sides
    moved = []
    for side in (1.0, -1.0):
        context.SetContinuousState(x + side * change)
        moved.append(diagram.EvalTimeDerivatives(context).CopyToVector())
    np.testing.assert_allclose(0.5 * (moved[0] - moved[1]), linear.A() @ change, rtol=1e-4, atol=1e-9)


def test_a_posture_that_muscles_cannot_hold_is_refused(arm):
    with pytest.raises(EquilibriumError, match=r"cannot hold the joint angles .* the shoulder lacks .* Nm"):
        find_equilibrium(arm, np.deg2rad([20.0, 60.0]), load_mass=5.0)
    with pytest.raises(StateError, match=r"joint angles .* expected 2 finite numbers"):
        find_equilibrium(arm, np.zeros(3))


def test_weakness_is_a_lack_only_where_the_muscles_pull_too_little():
    assert weakness("elbow", 3.0, 10.0) == "the elbow lacks 3 Nm of the 10 Nm that it needs"
    assert weakness("elbow", -3.0, -10.0) == "the elbow lacks 3 Nm of the 10 Nm that it needs"
    for missing, required, acts in (
        (-3.0, 1e-16, "exert 3 Nm on the elbow, which needs 0 Nm"),
        (-3.0, 2.0, "exert 5 Nm on the elbow, which needs 2 Nm"),
        (8.0, 5.0, "exert -3 Nm on the elbow, which needs 5 Nm"),
        (3.0, -2.0, "exert -5 Nm on the elbow, which needs -2 Nm"),
    ):
        assert weakness("elbow", missing, required) == f"passive forces, or muscles for another joint, {acts}"


def test_passive_forces_that_are_too_strong_are_no_lack(arm):
    """With the arm raised and the elbow bent, the long head of the triceps pulls the shoulder back."""
    with pytest.raises(EquilibriumError, match=r"passive forces, .* exert -.* Nm on the shoulder, which needs 6.82 Nm"):
        find_equilibrium(arm, np.deg2rad([60.0, 130.0]))


def test_a_muscle_that_would_tear_is_refused_with_its_name(arm):
    """With a short tendon its fiber fills the whole path, at three times its optimal length."""
    muscles = [replace(m, tendon="rigid", tendon_slack_length=1e-4) if m.name == "BIClong" else m for m in arm.muscles]
    with pytest.raises(EquilibriumError, match=r"BIClong of arm14 cannot be in equilibrium: the path is so long"):
        find_equilibrium(replace(arm, muscles=tuple(muscles)), POSTURES[0])


def test_torques_that_no_excitation_exerts_are_not_an_equilibrium(arm):
    """Also where they are small: the gravity of an arm whose muscles have hardly any force."""
    weak = tuple(replace(m, max_isometric_force=1e-6) for m in arm.muscles)
    light = replace(arm, muscles=weak, gravity=(0.0, -0.01, 0.0))
    with pytest.raises(EquilibriumError, match="cannot hold the joint angles"):
        find_equilibrium(light, POSTURES[0])


@pytest.mark.parametrize("least", [0.2, np.where(np.arange(14) == 5, 0.5, 0.05)])
def test_cocontraction_holds_the_same_torque_with_larger_activations(arm, least):
    relaxed, stiff = find_equilibrium(arm, POSTURES[0]), find_equilibrium(arm, POSTURES[0], least=least)
    np.testing.assert_allclose(stiff.torque, relaxed.torque, atol=1e-9)
    assert (stiff.activation >= least).all() and np.isclose(stiff.activation, least).any()
    diagram, muscle_arm = make_arm(arm, 1e-3)
    context = diagram.CreateDefaultContext()
    held = muscle_arm.SetEquilibrium(context, POSTURES[0], least=least)
    np.testing.assert_array_equal(held.activation, stiff.activation)
    tau = muscle_arm.muscles.GetOutputPort("generalized_force")
    np.testing.assert_allclose(tau.Eval(muscle_arm.muscles.GetMyContextFromRoot(context)), relaxed.torque, atol=1e-8)


def test_cocontraction_that_is_too_much_is_refused(arm):
    with pytest.raises(EquilibriumError, match=r"with these least activations: .* which needs 2.97 Nm"):
        find_equilibrium(arm, POSTURES[0], least=0.4)
    with pytest.raises(StateError, match="expected a number from 0 to 1"):
        find_equilibrium(arm, POSTURES[0], least=1.2)


@pytest.mark.parametrize(
    ("elbow", "found"), [(60.0, r"60 rad \(3438 deg\)"), (np.deg2rad(150.0), r"2.618 rad \(150 deg\)")]
)
def test_angles_outside_of_the_ranges_are_refused_with_the_joint(arm, elbow, found):
    """Joint stops are elastic, so that an arm can rest a little outside."""
    with pytest.raises(StateError, match=rf"the elbow is at {found}, expected .* 0 to 2.269 rad \(0 to 130 deg\)"):
        find_equilibrium(arm, np.array([0.0, elbow]))
    find_equilibrium(arm, np.array([0.0, -0.05]))


@pytest.mark.parametrize("angle", [1e7, np.nan, np.inf])
def test_joint_angles_have_a_limit(arm, angle):
    with pytest.raises(StateError, match="joint angles"):
        find_equilibrium(arm, np.array([0.0, angle]))
