"""Lifting: what counts as lifted, and what static strength predicts."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.planning.feasibility import muscle_feasibility
from drakearm.reproduction.lifting import Lifting, lacking_torque
from drakearm.reproduction.trial import Method, Trial


def errs(run, shoulder, elbow):
    return replace(run, q=run.reference_q + np.array([shoulder, elbow]))


def test_elbow_and_both_joints_are_judged_apart(make_outcome, runs):
    some = [errs(runs[0], *error) for error in [(0.0, 0.05), (0.3, 0.05), (0.0, 0.2)]]
    rows = Lifting().rows([make_outcome(Trial("lift-5kg-elbow", Method.default), some)])
    assert [str(row.values[Method.default]) for row in rows[:3]] == ["2 of 3 (67%)", "2 of 3 (67%)", "1 of 3 (33%)"]
    assert rows[0].group.startswith("5 kg, elbow and shoulder weighted (1, 0.2)")


@pytest.mark.parametrize("load_mass, predicted", [(0.0, "strong enough"), (20.0, "at the shoulder")])
def test_static_strength_predicts_which_torque_lacks(make_outcome, task, load_mass, predicted):
    outcome = make_outcome(Trial("lift-20kg", Method.static))
    outcome = replace(outcome, feasibility=muscle_feasibility(task.arm, task.reference, load_mass))
    assert predicted in lacking_torque(outcome)
