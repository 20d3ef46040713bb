"""Scatter under motor noise: none without noise, more with more noise, and Fitts' law for the shipped policy."""

import numpy as np
import pytest

from drakearm.experiments import scenario_task
from drakearm.repertoire import load_repertoire
from drakearm.repertoire.scatter import DURATIONS, fitts, scatter
from drakearm.repertoire.shipped import shipped_policy

HOME = np.deg2rad([-20.0, 80.0])


@pytest.fixture(scope="module")
def tasks():
    repertoire = load_repertoire("reaching")
    return [repertoire.task(scenario_task(name).reference) for name in ("reach-000", "reach-135")]


def test_the_hand_scatters_with_the_noise(tasks):
    act = shipped_policy("reaching").act
    none, some, more = (scatter(tasks, act, share) for share in (0.0, 0.1, 0.3))
    np.testing.assert_allclose(none, 0.0, atol=1e-9)
    assert (some > 0.01).all() and (more > 1.5 * some).all()
    np.testing.assert_array_equal(scatter(tasks, act, 0.1), some)
    assert (scatter(tasks, act, 0.1, seed=1) != some).all()


@pytest.mark.slow
def test_difficult_targets_take_longer(tasks):
    law = fitts(tasks[0], HOME, shipped_policy("reaching").act)
    assert law is not None and law.slope > 0.0 and law.correlation > 0.5
    assert set(law.duration) <= set(DURATIONS) and len(set(law.duration)) > 1


def test_a_policy_that_does_not_reach_hits_nothing(tasks):
    assert fitts(tasks[0], HOME, lambda observation: np.full((len(observation), 14), 0.5)) is None
