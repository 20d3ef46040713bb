"""Feasibility: whether the muscles can do a movement, and how the verdict says so."""

import numpy as np

from drakearm.model import MakeTorqueArm
from drakearm.model.skeleton import movement_torques
from drakearm.planning.feasibility import muscle_feasibility


def test_the_empty_hand_is_feasible(arm, reference):
    feasibility = muscle_feasibility(arm, reference)
    assert feasibility.feasible
    assert feasibility.verdict.startswith("The muscles can do it")
    assert feasibility.activation.shape == (len(reference.t), 14)
    np.testing.assert_allclose(feasibility.reserve, 0.0, atol=0.01)
    expected = movement_torques(MakeTorqueArm(arm), reference.q, reference.v, reference.a)
    np.testing.assert_allclose(feasibility.required, expected)


def test_twenty_kilograms_are_not_and_the_verdict_says_where(arm, reference):
    feasibility = muscle_feasibility(arm, reference, load_mass=20.0)
    missing = np.abs(feasibility.reserve)
    assert not feasibility.feasible
    assert missing[:, 0].max() == missing.max() > 10.0
    assert f"the shoulder lacks {missing.max():.3g} Nm" in feasibility.verdict
    assert f"at {reference.t[missing.max(axis=1).argmax()]:.2f} s" in feasibility.verdict
