"""The experiments of the paper: their trials, and how outcomes are sorted."""

import pytest

from drakearm.reproduction.catalog import EXPERIMENTS
from drakearm.reproduction.experiment import by_method, by_seed, shares, spreads
from drakearm.reproduction.trial import Method, Trial
from tests.shipped import PAPER

MOVEMENTS = {"reaching": 8, "timing": 4, "lifting": 10, "obstacle": 2}


@pytest.mark.parametrize("name, movements", MOVEMENTS.items())
def test_methods_that_learn_have_a_trial_per_movement_and_seed(name, movements):
    trials = EXPERIMENTS[name].trials(seeds=3)
    assert len(set(trials)) == len(trials) == movements * (1 + 3 + 3)
    assert {trial.seed for trial in trials if trial.method is Method.static} == {0}


def test_every_shipped_movement_of_the_paper_belongs_to_an_experiment():
    used = {trial.scenario for experiment in EXPERIMENTS.values() for trial in experiment.trials(seeds=1)}
    assert set(PAPER) == used


def test_outcomes_are_collected_by_method_and_seed(make_outcome):
    outcomes = [
        make_outcome(Trial(name, method, seed))
        for name in ("timing-0.4s", "timing-0.5s")
        for method, seed in [(Method.default, 1), (Method.default, 0), (Method.static, 0)]
    ]
    assert list(by_method(outcomes)) == [Method.static, Method.default]
    assert [[o.trial.seed for o in some] for some in by_seed(by_method(outcomes)[Method.default])] == [[0, 0], [1, 1]]
    spread = spreads(outcomes, lambda outcome: [float(outcome.trial.seed)])
    assert spread[Method.default].seeds == [[0.0, 0.0], [1.0, 1.0]]
    share = shares(outcomes, lambda outcome: [True] if outcome.trial.method is Method.static else [])
    assert list(share) == [Method.static]  # nothing was measured with the other one
