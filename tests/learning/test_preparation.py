"""What comes before PPO: `train` prepares as the settings say, if it is told nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.errors import TrainingError
from drakearm.learning import ArmVectorEnv, PpoSettings, prepare, train
from drakearm.learning.input_scaling import InputScaling

SETTINGS = PpoSettings(batches=1, environments=3, steps=6, minibatches=2, epochs=1, imitation_rounds=1)


@pytest.fixture
def short(task):
    return replace(task, reference=replace(task.reference, **{n: getattr(task.reference, n)[:6] for n in "tqva"}))


def weights(policy):
    return np.concatenate([array.ravel() for array in policy.weights.values()])


@pytest.mark.parametrize("rounds", [0, 1])
def test_the_tasks_of_the_arms_prepare_the_actor(short, rounds):
    settings = replace(SETTINGS, imitation_rounds=rounds)
    tasks = [short, replace(short, load_mass=1.0)]
    explicit = train(
        ArmVectorEnv(tasks, 3), settings, seed=2, prepare=lambda actor: prepare(actor, tasks, settings, seed=2)
    )
    np.testing.assert_array_equal(weights(train(ArmVectorEnv(tasks, 3), settings, seed=2)), weights(explicit))
    unprepared = train(ArmVectorEnv(tasks, 3), settings, seed=2, prepare=lambda actor: InputScaling.none(58))
    assert (weights(unprepared) != weights(explicit)).any()


def test_a_start_from_a_policy_is_no_preparation(short):
    policy = train(ArmVectorEnv(short, 3), SETTINGS, seed=0)
    with pytest.raises(TrainingError, match="Found prepare and initial_policy: expected one of them"):
        train(
            ArmVectorEnv(short, 3),
            SETTINGS,
            seed=0,
            prepare=lambda actor: InputScaling.none(58),
            initial_policy=policy,
        )
