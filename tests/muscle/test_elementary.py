"""The elementary functions of drakearm agree with those of NumPy."""

import math

import numpy as np
import pytest

from drakearm.muscle.elementary import GREATEST_EXPONENT, LEAST_EXPONENT, exp, sincos


def test_exp():
    x = np.concatenate([np.linspace(-30.0, 30.0, 5001), [0.0, LEAST_EXPONENT, GREATEST_EXPONENT]])
    np.testing.assert_allclose([exp(one) for one in x], np.exp(x), rtol=5e-16)
    assert exp(0.0) == 1.0
    assert math.isnan(exp(math.nan))


@pytest.mark.parametrize("largest", [1.0, 10.0, 1e5])
def test_sincos(largest):
    x = np.linspace(-largest, largest, 5001)
    np.testing.assert_allclose([sincos(one) for one in x], np.stack([np.sin(x), np.cos(x)], axis=1), atol=3e-16)
    assert np.isnan(sincos(math.nan)).all()
