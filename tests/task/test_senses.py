"""The table of senses, and the errors for senses and rewards that are impossible."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import TaskError
from drakearm.task import OBSERVATIONS, SENSES, SIGNALS, Observation, Sense, observation_set, signal_size


def test_observation_sets_consist_of_rows_of_the_table():
    assert [sense.name for sense in OBSERVATIONS["paper"]] == ["fiber_length", "fiber_velocity"]
    assert set(OBSERVATIONS["full"]) <= set(SENSES)
    with pytest.raises(TaskError, match="no observation set 'smell': expected one of paper, full"):
        observation_set("smell")


def test_each_sense_of_the_table_has_a_size_and_a_meaning(arm):
    for sense in SENSES:
        observation = Observation(arm, [sense], (0, 3, 8))
        (signal,) = sense.reads
        assert observation.size == signal_size(signal, arm, (0, 3, 8)) > 0
        assert sense.meaning
        assert observation({signal: np.ones((5, observation.size))}).shape == (5, observation.size)


def test_small_errors_are_resolved_and_large_ones_limited(arm):
    (sense,) = [sense for sense in SENSES if sense.name == "small_tracking_error"]
    sensed = Observation(arm, [sense], (0,))({"tracking_error": np.array([0.001, -10.0, 0.02, 0.0])})
    np.testing.assert_allclose(sensed, [0.1, -1.0, 0.1, 0.0], atol=1e-3)


def test_one_arm_and_many_arms_observe_the_same(task):
    rng = np.random.default_rng(0)
    sizes = {name: signal_size(name, task.arm, task.lookahead) for name in SIGNALS}
    signals = {name: rng.standard_normal((4, size)) for name, size in sizes.items()}
    many = task.observation(signals)
    for k in range(4):
        np.testing.assert_array_equal(task.observation({name: x[k] for name, x in signals.items()}), many[k])
    assert list(task.observation.places) == [sense.name for sense in task.senses]
    assert task.observation.places["activation"] == slice(28, 42)


def test_impossible_senses_and_rewards_are_refused_with_a_clear_sentence(task):
    with pytest.raises(TaskError, match="sense smell reads the signal 'smell': expected one of arm_state"):
        Sense("smell")
    with pytest.raises(TaskError, match="sense push reads the signal 'arm_acceleration'"):
        Sense("push", reads=("arm_acceleration",))
    with pytest.raises(TaskError, match="sense both reads 2 signals: expected a calc"):
        Sense("both", reads=("activation", "excitation"))
    with pytest.raises(TaskError, match="senses activation, activation"):
        replace(task, senses=(SENSES[2], SENSES[2])).observation.size  # noqa: B018
    wrong = Sense("wrong", reads=("activation",), calc=lambda activation: activation, size=3)
    with pytest.raises(TaskError, match=r"shapes wrong \(14,\): expected the last axes wrong 3"):
        replace(task, senses=(wrong,)).observation({"activation": np.zeros(14)})
