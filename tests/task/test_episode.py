"""Randomizations change what they name, within their ranges, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import StateError, TaskError
from drakearm.experiments import make_task_env
from drakearm.learning import ArmVectorEnv
from drakearm.task import (
    Episode,
    RandomDelay,
    Randomization,
    RandomLoad,
    RandomMotorNoise,
    RandomStart,
    RandomStrength,
    ReferenceStart,
    Start,
    StartState,
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


def changing(**changes):
    """A user's randomization, named Own."""
    attributes = {"type": "", "__call__": lambda self, episode, rng: episode._replace(**changes)}
    return type("Own", (Randomization,), attributes)()


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"load_mass": -1.0}, "a load_mass of -1.0: expected 0 to 1000 kg"),
        ({"load_mass": np.nan}, "a load_mass of nan: expected"),
        ({"load_mass": None}, "a load_mass of None: expected"),
        ({"strength": 0.0}, "a strength of 0.0: expected one factor or 14, one per muscle, from 0.01 to 100"),
        ({"strength": -1.0}, "a strength of -1.0: expected"),
        ({"strength": 1e6}, "a strength of 1000000.0: expected"),
        ({"strength": np.ones(13)}, r"a strength of array\(.*: expected one factor or 14"),
        ({"strength": np.full(14, np.nan)}, r"a strength of array\(.*: expected one factor or 14"),
        ({"senses_delay": 0.005}, "a delay of 0.005 s: expected 0 to 0.2 s, and a whole number"),
        ({"motor_noise": -0.1}, "a motor_noise of -0.1: expected 0 to 10"),
        ({"noise_seed": 0.5}, "a noise_seed of 0.5: expected a whole number"),
        ({"start": None}, "the start None: expected a StartState"),
    ],
)
def test_an_episode_that_is_not_possible_is_refused_in_both_environments(task, changes, sentence):
    own = replace(task, randomization=(changing(**changes),))
    for env in (ArmVectorEnv(own, 2), make_task_env(own)):
        with pytest.raises(TaskError, match=f"The randomization Own drew {sentence}"):
            env.reset(seed=0)


def test_a_forgotten_return_is_refused(task):
    forgetful = type("Own", (Randomization,), {"type": "", "__call__": lambda self, episode, rng: None})()
    with pytest.raises(TaskError, match="The randomization Own drew None: expected an Episode"):
        replace(task, randomization=(forgetful,)).episode(np.random.default_rng(0))


@pytest.mark.parametrize("randomization", [RandomLoad(0.0, 1.0), (RandomLoad,), ("load",)])
def test_the_randomization_of_a_task_is_a_tuple_of_instances(task, randomization):
    with pytest.raises(TaskError, match="expected a tuple of Randomizations"):
        replace(task, randomization=randomization)


def test_impossible_tasks_and_starts_are_refused(task):
    def start(*state):
        return type("Own", (Start,), {"__call__": lambda self, reference, rng: StartState(*state)})()

    q = task.reference.q[0]
    with pytest.raises(TaskError, match=r"The task has a load_mass of -1.0: expected 0 to 1000 kg"):
        replace(task, load_mass=-1.0)
    with pytest.raises(TaskError, match=r"The task has a start at step 75: expected one of the steps 0 to 74"):
        replace(task, start=start(q, 0.0, 0.05, 75))
    fast = replace(task, start=start(q, np.nan))
    for env in (ArmVectorEnv(fast, 2), make_task_env(fast)):
        with pytest.raises(StateError, match="joint speeds"):
            env.reset(seed=0)
