"""Computed muscle control for many arms is that of each arm alone, as `StaticOptimizer` computes it."""

import numpy as np
import pytest

from drakearm.model import MakeTorqueArm
from drakearm.model.loaded_dynamics import LoadedDynamics
from drakearm.model.muscle_control import excitations_for
from drakearm.model.skeleton import inverse_dynamics
from drakearm.model.static_optimization import acceleration_weighting, excitations_to_reach, static_activations


@pytest.mark.parametrize("priority", [(1.0, 1.0), (0.04, 1.0)])
def test_each_arm_gets_the_excitations_that_it_would_get_alone(arm, priority):
    rng, loads = np.random.default_rng(0), np.array([0.0, 2.0, 8.0])
    q, v, a = rng.uniform(0.2, 1.2, (3, 2)), rng.normal(0.0, 2.0, (3, 2)), rng.normal(0.0, 20.0, (3, 2))
    activation, guess = rng.uniform(0.01, 0.5, (3, 14)), np.full((3, 14), 0.1)
    weights, tables = np.tile(priority, (3, 1)), (arm.muscle_table, arm.path_table)
    dynamics = LoadedDynamics([arm]).stacked(np.zeros(3, dtype=int), loads)
    found = excitations_for(q, v, a, activation, guess, weights, 0.01, *tables, dynamics)
    for k, load in enumerate(loads):
        plant = MakeTorqueArm(arm, load)
        context = plant.CreateDefaultContext()
        plant.SetPositionsAndVelocities(context, np.concatenate([q[k], v[k]]))
        tau = inverse_dynamics(plant, context, a[k])
        weighting = acceleration_weighting(plant.CalcMassMatrix(context), weights[k])
        desired, _ = static_activations(q[k], v[k], tau, np.full(14, 0.1), weighting, *tables)
        expected = excitations_to_reach(desired, activation[k], 0.01, arm.muscle_table)
        np.testing.assert_allclose(found[k], expected, atol=1e-6)
        np.testing.assert_allclose(guess[k], desired, atol=1e-6)
