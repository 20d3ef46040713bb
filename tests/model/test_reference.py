"""References from measured angles: the samples, derivatives and torques of a movement that is known."""

import numpy as np
import pytest

from drakearm.errors import TaskError
from drakearm.model import CONTROL_STEP, MakeTorqueArm, Reference
from drakearm.model.skeleton import movement_torques


def angles(t, order=0):
    """A known movement (N, 2), rad, of 0.7 s, or its derivatives."""
    w = np.pi / 0.7
    shifted = np.cos(w * np.asarray(t) + order * np.pi / 2)[:, None]
    return (0.5 if order == 0 else 0.0) - np.array([0.2, 0.5]) * w**order * shifted


@pytest.mark.parametrize("rate", [60.0, 120.0, 100.0, 1000.0])
def test_the_reference_is_the_movement_that_was_measured(arm, rate):
    t = np.arange(0.0, 0.7 + 1e-9, 1.0 / rate)
    found = Reference.from_angles(arm, t + 3.0, angles(t), load_mass=1.0)
    found.check(arm)
    np.testing.assert_allclose(found.t, CONTROL_STEP * np.arange(len(found.t)))
    assert t[-1] - CONTROL_STEP < found.duration <= t[-1] + 1e-9
    for order, (values, tolerance) in enumerate(((found.q, 1e-6), (found.v, 1e-4), (found.a, 0.02))):
        np.testing.assert_allclose(values, angles(found.t, order), atol=tolerance)
    expected = movement_torques(MakeTorqueArm(arm, 1.0), found.q, found.v, found.a)
    np.testing.assert_allclose(found.tau, expected, rtol=1e-9, atol=1e-9)


def test_times_may_have_any_steps(arm):
    t = 0.7 * np.sort(np.concatenate([[0.0, 1.0], np.random.default_rng(0).uniform(0.0, 1.0, 60)]))
    np.testing.assert_allclose(Reference.from_angles(arm, t, angles(t)).q[-1], angles([0.7])[0], atol=1e-6)


@pytest.mark.parametrize(
    ("t", "q", "sentence"),
    [
        (np.arange(10.0), np.zeros((10, 3)), r"found t of the shape \(10,\) and q of the shape \(10, 3\), expected"),
        (np.arange(5.0), np.zeros((5, 2)), "found 5 samples, expected at least 6"),
        (np.array([0.0, 1, 2, 2, 3, 4]), np.zeros((6, 2)), r"t\[3\]: found 2 after 2, expected times that rise"),
        (np.arange(6.0), np.full((6, 2), np.nan), "not finite"),
        (np.arange(6.0), np.full((6, 2), 60.0), "found 60, expected a number from -10 to 10"),
        (1000.0 * np.arange(6.0), np.zeros((6, 2)), "found 5000 s, expected at most 200 s"),
    ],
)
def test_what_was_not_measured_is_refused(arm, t, q, sentence):
    with pytest.raises(TaskError, match=sentence):
        Reference.from_angles(arm, t, q)
