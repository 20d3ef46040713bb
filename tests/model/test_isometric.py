"""Isometric torques are those of a Diagram at rest, and the joint stiffness is their derivative."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams import AddMuscleArm
from drakearm.errors import EquilibriumError, StateError
from drakearm.model import find_equilibrium, isometric_torque, joint_stiffness

N = 14
Q = np.deg2rad([-20.0, 80.0])
ACTIVATION = np.linspace(0.05, 0.6, N)


def test_the_torque_is_that_of_a_diagram_at_rest(arm):
    builder = DiagramBuilder()
    muscle_arm = AddMuscleArm(builder, arm)
    context = builder.Build().CreateDefaultContext()
    muscle_arm.SetState(context, Q, activation=ACTIVATION)
    found = isometric_torque(arm, Q, ACTIVATION)
    for name, values in (
        ("generalized_force", found.torque),
        ("joint_moment", found.joint_moment.ravel()),
        ("tendon_force", found.tendon_force),
        ("fiber_length", found.fiber_length),
    ):
        port = muscle_arm.muscles.GetOutputPort(name)
        expected = port.Eval(muscle_arm.muscles.GetMyContextFromRoot(context))
        np.testing.assert_allclose(values, expected, rtol=1e-12, atol=1e-12)


def test_many_postures_are_those_one_by_one(arm):
    q = np.deg2rad([[0.0, angle] for angle in (0.0, 45.0, 90.0)])
    together = isometric_torque(arm, q, 1.0)
    assert [x.shape for x in together] == [(3, 2), (3, N, 2), (3, N), (3, N)]
    for k in range(3):
        for one, several in zip(isometric_torque(arm, q[k], 1.0), together, strict=True):
            np.testing.assert_allclose(several[k], one, rtol=1e-12)
    different = isometric_torque(arm, q, np.linspace(0.1, 0.3, 3)[:, None] * np.ones(N))
    np.testing.assert_allclose(different.torque[2], isometric_torque(arm, q[2], 0.3).torque, rtol=1e-12)


def test_muscles_that_hold_a_posture_exert_what_it_needs(arm):
    held = find_equilibrium(arm, Q, 1.0)
    np.testing.assert_allclose(isometric_torque(arm, Q, held.activation).torque, held.torque, rtol=1e-7)


@pytest.mark.parametrize("model", ["thelen2003", "degroote2016"])
@pytest.mark.parametrize("tendon", ["compliant", "rigid"])
@pytest.mark.parametrize("activation", [0.01, 0.2, ACTIVATION])
def test_the_stiffness_is_the_derivative_of_the_torque(arm, model, tendon, activation):
    arm = replace(arm, muscles=tuple(replace(m, model=model, tendon=tendon) for m in arm.muscles))
    h = 1e-4
    expected = [
        -(isometric_torque(arm, Q + step, activation).torque - isometric_torque(arm, Q - step, activation).torque)
        / (2 * h)
        for step in h * np.eye(2)
    ]
    stiffness = joint_stiffness(arm, Q, activation)
    np.testing.assert_allclose(stiffness, np.transpose(expected), rtol=1e-4, atol=1e-3)
    np.testing.assert_allclose(stiffness, stiffness.T, rtol=1e-6, atol=1e-6)


def test_cocontraction_makes_joints_stiffer(arm):
    """With the same torque: what co-contraction is for (Hogan 1984)."""
    relaxed, stiff = (find_equilibrium(arm, Q, least=least) for least in (0.0, 0.2))
    assert joint_stiffness(arm, Q, stiff.activation)[1, 1] > 2.0 * joint_stiffness(arm, Q, relaxed.activation)[1, 1]


def test_what_is_impossible_is_refused(arm):
    for compute in (isometric_torque, joint_stiffness):
        with pytest.raises(StateError, match=r"joint angles .* expected 2 finite numbers"):
            compute(arm, np.zeros(3), 0.1)
        with pytest.raises(StateError, match="the elbow is at 60 rad"):
            compute(arm, np.array([0.0, 60.0]), 0.1)
        with pytest.raises(StateError, match="activation is 2: expected a number from 0 to 1"):
            compute(arm, Q, 2.0)
    long = tuple(replace(m, tendon_slack_length=2.0) if m.name == "BRA" else m for m in arm.muscles)
    with pytest.raises(EquilibriumError, match="BRA"):
        isometric_torque(replace(arm, muscles=long), Q, 0.1)
