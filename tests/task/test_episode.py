"""Randomizations change what they name, within their ranges, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import TaskError
from drakearm.task import (
    Episode,
    RandomDelay,
    Randomization,
    RandomLoad,
    RandomMotorNoise,
    RandomStart,
    RandomStrength,
    ReferenceStart,
)


def drawn(task, *randomizations):
    task = replace(task, randomization=randomizations, start=ReferenceStart())
    rng = np.random.default_rng(0)
    return [task.episode(rng) for _ in range(300)]


def test_without_a_generator_nothing_is_random(task):
    task = replace(task, randomization=(RandomLoad(1.0, 2.0), RandomStart(5.0)), load_mass=0.5, senses_delay=0.02)
    episode = task.episode(None)
    np.testing.assert_array_equal(episode.start.q, task.reference.q[0])
    assert (episode.load_mass, episode.strength, episode.delay_steps) == (0.5, 1.0, 2)


def test_each_fills_its_range(task):
    def fills(values, least, most):
        return least <= min(values) < least + 0.1 * (most - least) and most - 0.1 * (most - least) < max(values) <= most

    episodes = drawn(
        task, RandomLoad(0.5, 2.0), RandomStrength(0.8, 1.2), RandomStart(3.0, 0.2), RandomDelay(0.0, 0.06)
    )
    assert fills([episode.load_mass for episode in episodes], 0.5, 2.0)
    assert fills([episode.strength for episode in episodes], 0.8, 1.2)
    assert {episode.delay_steps for episode in episodes} == set(range(7))
    offsets = np.array([episode.start.q - task.reference.q[0] for episode in episodes])
    assert all(fills(np.rad2deg(offsets[:, j]), -3.0, 3.0) for j in range(2))
    assert fills([episode.start.v[0] for episode in episodes], -0.2, 0.2)


def test_strengths_multiply(task):
    assert drawn(task, RandomStrength(0.5, 0.5), RandomStrength(0.5, 0.5))[0].strength == 0.25


@pytest.mark.parametrize("delay", [0.005, 0.21, -0.01])
def test_a_delay_is_a_whole_number_of_control_steps(task, delay):
    with pytest.raises(TaskError, match=r"expected 0 to 0.2 s, and a whole number"):
        replace(task, senses_delay=delay)
    with pytest.raises(TaskError, match="whole number"):
        _ = Episode(task.start(task.reference, None), 0.0, senses_delay=delay).delay_steps


def test_a_file_names_them_by_type():
    assert Randomization.read({"type": "load", "least": 0, "most": 2}) == RandomLoad(0.0, 2.0)
    with pytest.raises(ValueError, match="the smaller number first"):
        Randomization.read({"type": "strength", "least": 1.2, "most": 0.8})


def test_motor_noise_differs_between_episodes_and_is_the_same_again(task):
    first, second = drawn(task, RandomMotorNoise(0.2))[:2]
    factors = first.noise_factors(1000, 14)
    assert factors.shape == (1000, 14)
    np.testing.assert_allclose([factors.mean(), factors.std()], [1.0, 0.2], atol=0.01)
    np.testing.assert_array_equal(first.noise_factors(1000, 14), factors)
    assert (second.noise_factors(1000, 14) != factors).all()
    np.testing.assert_array_equal(task.episode(None).noise_factors(3, 14), 1.0)
