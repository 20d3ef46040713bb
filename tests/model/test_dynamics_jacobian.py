"""The compiled Jacobian of the accelerations agrees with automatic differentiation and finite differences."""

import numpy as np
import pytest
from pydrake.autodiffutils import ExtractGradient, InitializeAutoDiff
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model import MakeTorqueArm
from drakearm.model.dynamics import forward_dynamics
from drakearm.model.dynamics_jacobian import linearize_dynamics
from drakearm.model.dynamics_table import read_dynamics

from ..chains import make_chain


def points(n_q: int, count: int) -> np.ndarray:
    """Angles, speeds and torques (count, 3 n_q), usual and larger ones."""
    return np.random.default_rng(0).uniform(-1.0, 1.0, (count, 3 * n_q)) * np.repeat([3.0, 10.0, 20.0], n_q)


def differentiate_plant(plant: MultibodyPlant, point: np.ndarray) -> np.ndarray:
    differentiated = plant.ToAutoDiffXd()
    context = differentiated.CreateDefaultContext()
    x = InitializeAutoDiff(point).ravel()
    n = len(x) // 3
    differentiated.SetPositionsAndVelocities(context, x[: 2 * n])
    differentiated.get_applied_generalized_force_input_port().FixValue(context, x[2 * n :])
    return ExtractGradient(differentiated.get_generalized_acceleration_output_port().Eval(context))


def assert_same_jacobian(plant: MultibodyPlant) -> None:
    table = read_dynamics(plant)
    for point in points(plant.num_positions(), 10):
        q, v, tau = np.split(point, 3)
        a, jacobian = linearize_dynamics(q, v, tau, table)
        expected = differentiate_plant(plant, point)
        np.testing.assert_array_equal(a, forward_dynamics(q, v, tau, table))
        np.testing.assert_allclose(jacobian, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("load", [0.0, 5.0])
def test_arm_agrees_with_the_plant(arm, load):
    assert_same_jacobian(MakeTorqueArm(arm, load))


@pytest.mark.parametrize("joints", [1, 2, 3, 4])
def test_any_chain_of_revolute_joints_agrees_with_the_plant(joints):
    assert_same_jacobian(make_chain(joints))


@pytest.mark.parametrize("joints", [1, 2, 4])
def test_agrees_with_finite_differences(joints):
    table = read_dynamics(make_chain(joints))
    for point in points(joints, 5):
        _, jacobian = linearize_dynamics(*np.split(point, 3), table)
        scale = np.abs(jacobian).max()
        for k in range(3 * joints):
            # From five points, so that the error is of fourth order in the step.
            ahead, behind, far_ahead, far_behind = (
                forward_dynamics(*np.split(point + steps * 1e-3 * np.eye(3 * joints)[k], 3), table)
                for steps in (1, -1, 2, -2)
            )
            numeric = (8.0 * (ahead - behind) - (far_ahead - far_behind)) / 12e-3
            np.testing.assert_allclose(jacobian[:, k], numeric, rtol=0.0, atol=1e-9 * scale)
