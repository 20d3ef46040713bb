"""ProcessVectorEnv: as Gymnasium's vector environments, for any number of processes; errors end all processes."""

import multiprocessing
import os
import signal
import time
from functools import partial

import numpy as np
import pytest
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv

from drakearm.errors import ActionError, TrainingError
from drakearm.learning import PpoSettings, train
from drakearm.learning.checkpoint import Environments
from drakearm.learning.process_vector_env import ProcessVectorEnv
from tests.small_environments import SAME_STEP, Counter, Tracker

TRACKERS = [Tracker] * 5
COUNTERS = [partial(Counter, length=length, terminates=length % 2 == 0) for length in (2, 3, 4, 5, 6)]


@pytest.fixture(autouse=True)
def interruptible():
    """A shell that starts the tests in the background lets them ignore Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(autouse=True)
def no_process_is_left():
    before = set(multiprocessing.active_children())
    yield
    assert set(multiprocessing.active_children()) <= before


@pytest.fixture
def make():
    """Makes a ProcessVectorEnv, which is closed after the test."""
    made = []

    def make(make_envs, processes):
        made.append(ProcessVectorEnv(make_envs, processes))
        return made[-1]

    yield make
    for envs in made:
        envs.close()


def assert_same(found, expected):
    """That nested tuples and dictionaries of arrays are equal, also in the types of the arrays."""
    assert type(found) is type(expected)
    if isinstance(expected, dict):
        assert found.keys() == expected.keys()
        for name in expected:
            assert_same(found[name], expected[name])
    elif isinstance(expected, tuple):
        for one, other in zip(found, expected, strict=True):
            assert_same(one, other)
    else:
        assert found.dtype == expected.dtype
        for one, other in zip(found, expected, strict=True):  # of objects: None or an array
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("processes", [1, 2, 3, 9])
@pytest.mark.parametrize("gymnasiums", [SyncVectorEnv, AsyncVectorEnv])
@pytest.mark.parametrize("make_envs", [TRACKERS, COUNTERS])
def test_it_returns_what_gymnasiums_vector_environments_return(make, make_envs, gymnasiums, processes):
    ours, theirs = make(make_envs, processes), gymnasiums(make_envs, autoreset_mode=SAME_STEP)
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    assert ours.metadata["autoreset_mode"] == theirs.metadata["autoreset_mode"]
    rng = np.random.default_rng(0)
    for seed in (3, [5, 1, 5, None, 2], None):
        assert_same(ours.reset(seed=seed), theirs.reset(seed=seed))
        for _ in range(25):
            actions = rng.uniform(-1.0, 1.0, (5, 1))
            assert_same(ours.step(actions), theirs.step(actions))
    theirs.close()


def test_there_are_as_many_processes_as_said_and_by_default_as_cores(make):
    before = len(multiprocessing.active_children())
    make(TRACKERS, 2)
    assert len(multiprocessing.active_children()) - before == 2
    cores = len(os.sched_getaffinity(0))
    make([Tracker] * (cores + 1), None)
    assert len(multiprocessing.active_children()) - before == 2 + cores


def test_a_training_does_not_depend_on_the_number_of_processes(make):
    settings = PpoSettings(batches=2, environments=5, steps=24, minibatches=2, initial_std=0.3, imitation_rounds=0)

    def weights(envs):
        policy = train(envs, settings, seed=0, metadata={})
        return np.concatenate([weight.ravel() for weight in policy.weights.values()])

    expected = weights(SyncVectorEnv(TRACKERS, autoreset_mode=SAME_STEP))
    for processes in (1, 2):
        np.testing.assert_array_equal(weights(make(TRACKERS, processes)), expected)


class Kept(Counter):
    @property
    def state(self):
        return {"count": np.array(self.count)}

    @state.setter
    def state(self, arrays):
        self.count = int(arrays["count"])


def test_the_states_of_all_environments_are_read_and_set(make):
    envs = make([Kept] * 3, 2)
    envs.reset()
    envs.step(np.zeros((3, 1)))
    kept = Environments(envs).state
    observation, *_ = envs.step(np.zeros((3, 1)))
    Environments(envs).state = kept
    np.testing.assert_array_equal(envs.step(np.zeros((3, 1)))[0], observation)
    assert envs.get_attr("length") == (5, 5, 5)
    envs.set_attr("length", [1, 2, 3])
    assert envs.get_attr("length") == (1, 2, 3)


class Fails(Counter):
    """Calls a function in its second step."""

    def __init__(self, failure):
        super().__init__()
        self.failure = failure

    def step(self, action):
        if self.count == 1:
            self.failure()
        return super().step(action)


def act_wrongly():
    raise ActionError("wrong action")


def is_killed():
    os.kill(os.getpid(), signal.SIGKILL)


def interrupt():
    os.kill(os.getppid(), signal.SIGINT)
    time.sleep(60)


@pytest.mark.parametrize(
    ("failure", "error", "message"),
    [
        (act_wrongly, ActionError, "wrong action"),
        (is_killed, TrainingError, r"ended with exit code -9: .* memory"),
        (interrupt, KeyboardInterrupt, None),
    ],
)
def test_an_environment_that_fails_ends_all_processes(failure, error, message):
    envs = ProcessVectorEnv([Counter, partial(Fails, failure), Counter], 3)
    envs.reset()
    envs.step(np.zeros((3, 1)))
    with pytest.raises(error, match=message) as raised:
        envs.step(np.zeros((3, 1)))
    if failure is act_wrongly:
        assert "in act_wrongly" in raised.value.__notes__[0]
    with pytest.raises(TrainingError, match="have ended"):
        envs.step(np.zeros((3, 1)))


def test_a_process_that_was_killed_between_two_steps_is_reported():
    envs = ProcessVectorEnv(TRACKERS, 2)
    envs.reset()
    victim = multiprocessing.active_children()[0]
    victim.kill()
    victim.join()
    with pytest.raises(TrainingError, match="exit code -9"):
        envs.step(np.zeros((5, 1)))


def test_the_processes_end_with_their_parent():
    fork = multiprocessing.get_context("fork")
    ours, its = fork.Pipe()

    def parent():
        envs = ProcessVectorEnv(TRACKERS, 3)
        envs.reset()
        its.send([process.pid for process in multiprocessing.active_children()])
        is_killed()

    process = fork.Process(target=parent)
    process.start()
    workers = ours.recv()
    process.join()
    assert len(workers) == 3
    deadline = time.monotonic() + 60.0
    while any(is_running(worker) for worker in workers):
        assert time.monotonic() < deadline
        time.sleep(0.01)


def is_running(pid):
    """Not so for a process that has ended and that nobody has asked for its exit code."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_as_many_actions_as_environments_are_expected(make):
    envs = make(TRACKERS, 2)
    envs.reset()
    with pytest.raises(ActionError, match="4 actions: expected 5"):
        envs.step(np.zeros((4, 1)))
