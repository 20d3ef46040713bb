"""StaticOptimizer: its excitations for known inputs."""

import numpy as np
from pydrake.systems.analysis import Simulator

from drakearm.model import MakeTorqueArm
from drakearm.model.feedback import Feedback
from drakearm.model.reference import CONTROL_STEP
from drakearm.model.skeleton import movement_torques
from drakearm.model.static_optimization import static_activations
from drakearm.systems import StaticOptimizer

POSTURE, STILL = np.deg2rad([-20.0, 80.0]), np.zeros(2)


def decide(optimizer, q, v, activation, reference):
    simulator = Simulator(optimizer)
    context = simulator.get_mutable_context()
    inputs = {"arm_state": np.concatenate([q, v]), "activation": activation, "reference": np.concatenate(reference)}
    for name, value in inputs.items():
        optimizer.GetInputPort(name).FixValue(context, value)
    simulator.AdvanceTo(0.5 * CONTROL_STEP)
    return optimizer.GetOutputPort("excitation").Eval(context)


def activations(arm, q, a, load_mass=0.0):
    """The activations (n,) that accelerate the resting arm by a (n_q,), rad/s^2."""
    (tau,) = movement_torques(MakeTorqueArm(arm, load_mass), q[None], STILL[None], a[None])
    desired, _ = static_activations(q, STILL, tau, np.full(14, 0.1), np.eye(2), arm.muscle_table, arm.path_table)
    return desired


def test_keeps_activations_that_hold_the_arm_and_its_load(arm):
    desired = activations(arm, POSTURE, STILL, load_mass=3.0)
    excitation = decide(StaticOptimizer(arm, load_mass=3.0), POSTURE, STILL, desired, (POSTURE, STILL, STILL))
    np.testing.assert_allclose(excitation, desired, atol=1e-3)


def test_feedback_adds_to_the_desired_acceleration(arm):
    away, drift, a = np.array([0.02, -0.01]), np.array([0.1, 0.2]), np.array([1.0, -2.0])
    desired = activations(arm, POSTURE, a + 100.0 * away + 10.0 * drift)
    optimizer = StaticOptimizer(arm, feedback=Feedback(stiffness=100.0, damping=10.0))
    excitation = decide(optimizer, POSTURE, STILL, desired, (POSTURE + away, drift, a))
    np.testing.assert_allclose(excitation, desired, atol=1e-3)
