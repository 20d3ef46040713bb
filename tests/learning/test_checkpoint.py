"""A training that is stopped and continued ends with the same policy, bit for bit."""

from dataclasses import replace

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from drakearm.errors import TrainingError
from drakearm.experiments import make_task_env, scenario_task
from drakearm.learning import ArmVectorEnv, PpoSettings, train
from drakearm.learning.checkpoint import Checkpoint
from drakearm.learning.generator_state import generator_state, restored_generator
from drakearm.learning.input_scaling import InputScaling
from drakearm.task import RandomDelay, RandomLoad, RandomMotorNoise, RandomStart, RandomStrength

SETTINGS = PpoSettings(batches=4, environments=3, steps=40, minibatches=2, epochs=2)
DROPPED = ("steps_per_second", "seconds_left")


@pytest.fixture(scope="module")
def task():
    return scenario_task("timing-0.7s")


def arms(task):
    return ArmVectorEnv(task, SETTINGS.environments)


def varied_arms(task):
    task = replace(task, randomization=(RandomLoad(0.0, 2.0), RandomStart(2.0), RandomMotorNoise(0.2)))
    return ArmVectorEnv([task, replace(task, load_mass=1.0)], SETTINGS.environments, redraw=True)


def diagrams(task):
    envs = [lambda: make_task_env(task)] * SETTINGS.environments
    return SyncVectorEnv(envs, autoreset_mode=AutoresetMode.SAME_STEP)


def varied_diagrams(task):
    drawn = (RandomLoad(0.0, 2.0), RandomStrength(0.8, 1.2), RandomDelay(0.0, 0.03), RandomMotorNoise(0.2))
    task = replace(task, randomization=drawn)
    envs = [lambda: make_task_env([task, replace(task, load_mass=1.0)])] * SETTINGS.environments
    return SyncVectorEnv(envs, autoreset_mode=AutoresetMode.SAME_STEP)


def weights(policy):
    return np.concatenate([array.ravel() for array in policy.weights.values()])


class Stopped(Exception):
    pass


def stopped_after(batch):
    def stop(report):
        if report.batch == batch:
            raise Stopped

    return stop


@pytest.mark.parametrize("make_envs", [arms, varied_arms, diagrams, varied_diagrams])
@pytest.mark.parametrize("final_std", [0.01, None])
def test_a_continued_training_ends_with_the_same_policy(task, tmp_path, make_envs, final_std):
    """Stopped twice, in new environments each time, in the middle of the arms' episodes."""
    settings = replace(SETTINGS, final_std=final_std)
    files = {"resume_path": tmp_path / "checkpoint.safetensors", "log_path": tmp_path / "log.csv"}
    prepared = []

    def prepare(actor):
        prepared.append(actor)
        return InputScaling(np.full(58, 0.5, np.float32), np.full(58, 2.0, np.float32))

    whole = train(make_envs(task), settings, seed=5, metadata={}, prepare=prepare)
    for batch in (1, 3):
        with pytest.raises(Stopped):
            train(
                make_envs(task),
                settings,
                seed=5,
                metadata={},
                prepare=prepare,
                on_batch=stopped_after(batch),
                **files,
            )
    continued = train(make_envs(task), settings, seed=5, metadata={}, **files)
    np.testing.assert_array_equal(weights(continued), weights(whole))
    assert len(prepared) == 2  # imitation is not repeated
    rows = files["log_path"].read_text().splitlines()
    assert [row.split(",")[0] for row in rows] == ["batch", "1", "2", "3", "4"]
    assert [row.split(",")[2] for row in rows[1:]] == ["120", "240", "360", "480"]


@pytest.mark.parametrize("make_envs", [arms, diagrams])
def test_the_state_of_environments_is_complete(task, make_envs):
    """Two sets of environments with the same state give the same observations, across resets."""
    first, second = make_envs(task), make_envs(task)
    rng = np.random.default_rng(0)
    actions = rng.uniform(0.0, 1.0, (100, *first.action_space.shape)).astype(np.float32)
    first.reset(seed=1)
    second.reset(seed=2)
    for action in actions[:33]:
        first.step(action)
    if make_envs is arms:
        second.state = first.state
    else:
        second.set_attr("state", list(first.get_attr("state")))
    for action in actions[33:]:
        for ours, theirs in zip(first.step(action)[:2], second.step(action)[:2], strict=True):
            np.testing.assert_array_equal(ours, theirs)


def test_the_state_of_a_generator_is_complete():
    generator = np.random.default_rng(3)
    generator.integers(10, dtype=np.uint32)  # half a number is kept for the next call
    restored = restored_generator(generator_state(generator))
    for draw in (lambda g: g.integers(10, size=5, dtype=np.uint32), lambda g: g.standard_normal(9)):
        np.testing.assert_array_equal(draw(generator), draw(restored))


def test_another_training_is_refused(task, tmp_path):
    file = tmp_path / "checkpoint.safetensors"
    with pytest.raises(Stopped):
        train(arms(task), SETTINGS, seed=5, metadata={}, resume_path=file, on_batch=stopped_after(1))
    with pytest.raises(TrainingError, match="another seed"):
        train(arms(task), SETTINGS, seed=6, metadata={}, resume_path=file)
    with pytest.raises(TrainingError, match="another settings"):
        train(arms(task), replace(SETTINGS, epochs=3), seed=5, metadata={}, resume_path=file)
    named = r"settings.batches \(4 instead of 9\) and settings.epochs \(2 instead of 3\) and metadata.name"
    with pytest.raises(TrainingError, match=f"another {named}"):
        train(arms(task), replace(SETTINGS, batches=9, epochs=3), seed=5, metadata={"name": "other"}, resume_path=file)


@pytest.mark.parametrize("content", [b"", b"no checkpoint", b"\x08\x00\x00\x00\x00\x00\x00\x00{}      "])
def test_another_file_is_refused(tmp_path, content):
    file = tmp_path / "checkpoint.safetensors"
    file.write_bytes(content)
    with pytest.raises(TrainingError, match=r"checkpoint\.safetensors is"):
        Checkpoint.load(file)
