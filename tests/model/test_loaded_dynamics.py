"""The equations of motion for any load agree with those of a plant that has this load."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drakearm.model import MakeTorqueArm, load_arm
from drakearm.model.dynamics import forward_dynamics
from drakearm.model.dynamics_table import read_dynamics
from drakearm.model.loaded_dynamics import LoadedDynamics

ARM = load_arm("arm14")
MOON = replace(ARM, name="moon", gravity=(0.0, -1.62, 0.0))
LOADED = LoadedDynamics([ARM, MOON])


def accelerations(table, count, k, q, v, tau):
    """Of skeleton k of a stacked table."""
    coefficients = {name: getattr(table, name).reshape(count, -1)[k] for name in table._fields if "coeff" in name}
    return forward_dynamics(q, v, tau, table._replace(**coefficients))


@settings(max_examples=15, deadline=None)
@given(st.floats(0.0, 50.0), st.integers(0, 2**31))
def test_it_is_the_plant_with_this_load(load, seed):
    rng = np.random.default_rng(seed)
    q, v, tau = rng.normal(0.0, 1.0, 2), rng.normal(0.0, 3.0, 2), rng.normal(0.0, 5.0, 2)
    table = LOADED.stacked(np.array([0, 1]), np.array([load, load]))
    for k, arm in enumerate((ARM, MOON)):
        expected = forward_dynamics(q, v, tau, read_dynamics(MakeTorqueArm(arm, load)))
        np.testing.assert_allclose(accelerations(table, 2, k, q, v, tau), expected, rtol=1e-9, atol=1e-9)


def test_all_loads_have_the_same_terms():
    one, other = (LOADED.stacked(np.array([0]), np.array([load])) for load in (0.0, 3.0))
    for name in one._fields:
        if "coefficient" not in name:
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert one.mass_coefficient != pytest.approx(other.mass_coefficient)
