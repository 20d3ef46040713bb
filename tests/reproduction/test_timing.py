"""Timing: when a movement is learned, and how perturbed runs are counted."""

from dataclasses import replace

import numpy as np

from drakearm.reproduction.experiment import end_error
from drakearm.reproduction.timing import Timing, batches_to_learn
from drakearm.reproduction.trial import Method, Trial


def test_learned_after_the_last_batch_with_a_large_error():
    assert batches_to_learn(np.array([0.5, 0.09, 0.2, 0.09, 0.01])) == 3
    assert batches_to_learn(np.array([0.05, 0.01])) == 0
    assert batches_to_learn(np.array([0.05, np.nan])) == 2  # never


def off_at_the_end(run, error):
    q = run.reference_q.copy()
    q[-1, 1] += error
    return replace(run, q=q)


def test_perturbed_runs_are_counted_by_the_error_of_the_worse_joint_at_the_end(make_outcome, runs):
    some = [off_at_the_end(runs[0], error) for error in (0.01, -0.07, 0.2, -0.02)]
    np.testing.assert_allclose([end_error(run) for run in some], [0.01, 0.07, 0.2, 0.02])
    rows = Timing().rows([make_outcome(Trial("timing-0.4s", Method.ppo_alone, seed), some) for seed in range(2)])
    counts = [str(row.values[Method.ppo_alone]) for row in rows if row.group == "perturbed runs"]
    assert counts == ["6 of 8 (75%)", "4 of 8 (50%)"]


def test_static_optimization_learns_nothing(make_outcome):
    outcomes = [make_outcome(Trial("timing-0.4s", method)) for method in Method]
    (learning,) = [row for row in Timing().rows(outcomes) if row.group == "learning"]
    assert set(learning.values) == {Method.ppo_alone, Method.default}
