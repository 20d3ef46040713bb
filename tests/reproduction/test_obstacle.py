"""The obstacle: its distance from the arm in a run, also between the samples."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.experiments import load_scenario
from drakearm.reproduction.obstacle import Bar, ObstacleAvoidance
from drakearm.reproduction.trial import Method, Trial


def test_clearance_is_negative_where_the_hand_goes_through_the_bar(arm, runs):
    """The elbow bends with the upper arm still: the hand's circle goes through the bar."""
    t, distances = Bar(arm).clearance(runs[0])
    assert distances.shape == (len(t), len(arm.outline))
    assert t[1] - t[0] == pytest.approx(1e-3)
    assert distances.min() < -0.01 and distances[0].min() > 0.1


def test_clearance_is_dense(arm, runs):
    every_20th = slice(None, None, 20)
    run = runs[0]
    coarse = replace(run, t=run.t[every_20th], q=run.reference_q[every_20th], v=run.reference_v[every_20th])
    fine = replace(run, q=run.reference_q, v=run.reference_v)
    of_coarse, of_fine = (Bar(arm).clearance(each)[1].min() for each in (coarse, fine))
    assert of_coarse == pytest.approx(of_fine, abs=0.005)


def test_runs_with_contact_are_counted(make_outcome, runs, arm):
    still = replace(runs[0], q=np.zeros_like(runs[0].q), v=np.zeros_like(runs[0].v))
    rows = ObstacleAvoidance().rows([make_outcome(Trial("obstacle", Method.default), [still, runs[0]])])
    assert str(rows[0].values[Method.default]) == "1 of 2 (50%)"
    assert Bar(arm).obstacle == load_scenario("obstacle").obstacle
