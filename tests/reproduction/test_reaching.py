"""Reaching: what a hand that moves in a known way is judged to do."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.reproduction.hand import desired_path
from drakearm.reproduction.minimum_jerk import minimum_jerk_speed
from drakearm.reproduction.reaching import Reaching, measure_reaches
from drakearm.reproduction.trial import Method, Trial


@pytest.fixture
def straight(task, runs):
    """Makes a run whose hand moves straight to the target with minimum jerk and stops short of it by a share."""
    path = desired_path(task)
    phase = np.clip(runs[0].t / 0.5, 0.0, 1.0)
    place = 10 * phase**3 - 15 * phase**4 + 6 * phase**5

    def make(short: float):
        way = (1.0 - short) * (path[-1] - path[0])
        return replace(
            runs[0], p_WH=path[0] + place[:, None] * way, v_WH=2.0 * minimum_jerk_speed(phase)[:, None] * way
        )

    return make


def test_minimum_jerk_along_a_line_is_recognized(make_outcome, straight):
    outcome = make_outcome(Trial("reach-000", Method.default), [straight(0.0), straight(0.05)])
    rows = {row.quantity: row.values[Method.default] for row in Reaching().rows([outcome])}
    assert rows["mean, correlation with minimum jerk"].mean == pytest.approx(1.0, abs=1e-3)
    assert rows["largest deviation of the path from a straight line, over its length"].mean < 1e-6
    assert rows["peak over mean"].mean == pytest.approx(1.66, abs=0.01)
    assert rows["speed of the hand at the end (cm/s)"].mean == pytest.approx(0.0, abs=1e-9)


def test_success_is_to_end_within_10_percent_of_the_amplitude(make_outcome, straight):
    outcome = make_outcome(Trial("reach-000", Method.default), [straight(0.09), straight(0.11)])
    (reaches,) = measure_reaches([outcome])[Method.default]
    assert [run.success for run in reaches.runs] == [True, False]
    amplitude = np.linalg.norm(np.diff(desired_path(outcome.task)[[0, -1]], axis=0))
    assert reaches.runs[1].end_error == pytest.approx(0.11 * amplitude)
