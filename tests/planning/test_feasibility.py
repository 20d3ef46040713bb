"""Feasibility: whether the muscles can do a movement, and how the verdict says so."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import TaskError
from drakearm.model import MakeTorqueArm, Reference
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


def test_advice_is_more_time_only_where_this_helps(arm, reference):
    assert muscle_feasibility(arm, reference, 20.0).advice.startswith("More time does not help")
    quick = replace(reference, v=3.0 * reference.v, a=9.0 * reference.a)
    feasibility = muscle_feasibility(arm, quick)
    assert not feasibility.feasible and feasibility.advice.startswith("Expected more time")
    raised = replace(reference, q=np.full_like(reference.q, 1.5), v=0.0 * reference.v, a=0.0 * reference.a)
    assert "at the start: expected another start" in muscle_feasibility(arm, raised).advice
    lifted = replace(raised, q=np.linspace([0.0, 1.0], [1.5, 1.5], len(reference.t)))
    assert "at the target: expected another target" in muscle_feasibility(arm, lifted).advice


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda r: replace(r, t=0.5 * r.t), "cannot follow the reference: t.1.: found 0.005, expected 0.01"),
        (lambda r: replace(r, a=r.a[:, :1]), "cannot follow the reference: a: found n_q = 1, expected n_q = 2"),
        (lambda r: Reference(r.t, *(x[:, :1] for x in (r.q, r.v, r.a, r.tau))), "has 1 joints: expected 2"),
        (lambda r: replace(r, q=r.q + 60.0), "q.0, 0.: found 60, expected a number from -10 to 10"),
        (
            lambda r: replace(r, q=r.q + np.array([0.0, 1.0])),
            r"the elbow is at 2.571 rad \(147.3 deg\), expected .* 0 to 2.269 rad \(0 to 130 deg\)",
        ),
    ],
)
def test_a_reference_that_does_not_fit_the_arm_is_refused(arm, reference, change, sentence):
    with pytest.raises(TaskError, match=sentence):
        muscle_feasibility(arm, change(reference))


def test_a_reference_may_exceed_the_ranges_a_little(arm, reference):
    """As an arm does that presses into its joint stops."""
    assert muscle_feasibility(arm, replace(reference, q=reference.q - np.array([0.0, 0.05]))).feasible
