"""PPO on small environments with known solutions."""

import csv
import math
from dataclasses import fields, replace

import numpy as np
import pytest
import torch
from gymnasium.spaces import Discrete
from gymnasium.vector import AutoresetMode

from drakearm.errors import TrainingError
from drakearm.learning import BatchReport, PpoSettings, train
from drakearm.learning.policy import Policy
from tests.small_environments import NEXT_STEP, SAME_STEP, Counter, Tracker, tracking_return, vectorize

SMALL = PpoSettings(
    batches=3,
    environments=4,
    steps=16,
    epochs=4,
    minibatches=4,
    initial_action=0.0,
    actor_layers=(16, 16),
    critic_layers=(16,),
    learning_rate=1e-3,
    target_kl=None,
    initial_std=0.3,
    final_std=None,
    imitation_rounds=0,
)


@pytest.mark.parametrize("mode", [NEXT_STEP, SAME_STEP])
@pytest.mark.parametrize(("terminates", "value"), [(False, 1 / (1 - 0.7)), (True, 1 + 0.7 + 0.7**2)])
def test_value_looks_beyond_a_time_limit_but_not_beyond_a_termination(mode, terminates, value):
    envs = vectorize(Counter, mode=mode, length=3, terminates=terminates)
    settings = replace(SMALL, batches=50, gamma=0.7, learning_rate=1e-2, critic_learning_rate=1e-2)
    reports = []
    policy = train(envs, settings, seed=0, metadata={}, on_batch=reports.append)
    assert policy.value([0.0]) == pytest.approx(value, rel=0.15)
    if terminates:  # then the returns vary, and the observation determines them
        assert reports[-1].explained_variance > 0.95


@pytest.mark.parametrize("mode", [NEXT_STEP, SAME_STEP])
def test_learns_to_track(mode):
    settings = replace(SMALL, batches=40, environments=8, steps=40, epochs=8, gamma=0.9)
    settings = replace(settings, learning_rate=3e-3, critic_learning_rate=3e-3)
    reports = []
    envs = vectorize(Tracker, n=8, mode=mode)
    policy = train(envs, settings, seed=1, metadata={}, on_batch=reports.append)
    first, last = reports[0], reports[-1]
    assert first.mean_reward < -5
    assert last.tracking_error < 0.15 < first.tracking_error  # rad, with exploration
    assert last.std < 0.15 < first.std
    assert last.steps == 40 * 320 if mode == SAME_STEP else last.steps < 40 * 320

    assert tracking_return(policy) > -0.2


def test_the_same_seed_gives_the_same_policy():
    def weights(seed):
        policy = train(vectorize(Tracker), SMALL, seed=seed, metadata={})
        return np.concatenate([weight.ravel() for weight in policy.weights.values()])

    torch.manual_seed(0)
    first = weights(7)
    torch.manual_seed(1)
    np.testing.assert_array_equal(weights(7), first)
    assert (weights(8) != first).any()


def test_the_log_has_one_row_per_batch_with_the_values_of_its_report(tmp_path):
    path = tmp_path / "run" / "training.csv"
    reports = []
    rows_seen = []

    def on_batch(report):
        reports.append(report)
        rows_seen.append(len(path.read_text().splitlines()) - 1)

    train(vectorize(Tracker), SMALL, seed=0, metadata={}, log_path=path, on_batch=on_batch)
    with path.open() as file:
        rows = list(csv.DictReader(file))
    assert rows_seen == [1, 2, 3]  # written during the training
    assert list(rows[0]) == [field.name for field in fields(BatchReport)]
    assert [int(row["batch"]) for row in rows] == [1, 2, 3]
    for row, report in zip(rows, reports, strict=True):
        assert float(row["tracking_error"]) == report.tracking_error > 0
        assert float(row["approx_kl"]) == report.approx_kl >= -1e-6  # 0 but for rounding while the actor rests
    assert math.isnan(reports[0].mean_reward)  # no episode ends in the 16 steps of the first batch
    assert reports[1].mean_reward < 0
    assert reports[-1].seconds_left == 0


def test_tracking_error_is_nan_if_info_has_none():
    reports = []
    train(vectorize(Counter), SMALL, seed=0, metadata={}, on_batch=reports.append)
    assert all(math.isnan(report.tracking_error) for report in reports)


def test_a_killed_training_leaves_a_checkpoint_and_a_finished_one_the_policy(tmp_path):
    path = tmp_path / "policy.safetensors"
    settings = replace(SMALL, batches=20)

    def kill(report):
        if report.batch == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(vectorize(Tracker), settings, seed=0, metadata={}, checkpoint_path=path, on_batch=kill)
    observation = np.array([0.1, 0.2])
    early = Policy.load(path).act(observation)
    policy = train(vectorize(Tracker), settings, seed=0, metadata={"a": 1}, checkpoint_path=path)
    final = Policy.load(path)
    np.testing.assert_array_equal(final.act(observation), policy.act(observation))
    assert final.metadata == {"a": 1}
    assert (final.act(observation) != early).any()


def test_training_restores_the_number_of_threads():
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    try:
        train(vectorize(Counter), replace(SMALL, batches=1), seed=0, metadata={})
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before)


class Discretes(Counter):
    action_space = Discrete(3)


class Breaks(Counter):
    """Observes nan at its 20th step."""

    def step(self, action):
        _, *rest = super().step(action)
        return np.array([math.nan if self.count == 20 else 0.0]), *rest


@pytest.mark.parametrize(
    ("environment", "arguments", "changes", "sentence"),
    [
        (Counter, {"mode": AutoresetMode.DISABLED}, {}, "autoreset mode NEXT_STEP or SAME_STEP"),
        (Discretes, {}, {}, "Box of one axis as action space"),
        (Counter, {"n": 3}, {}, "ask for 4 environments, but the vector environment holds 3"),
        (Counter, {}, {"minibatches": 40}, "40 minibatches are too many"),
        (Breaks, {"length": 100}, {}, "an observation that is not finite in batch 2"),
        (Counter, {"reward": math.inf}, {}, "a reward that is not finite in batch 1"),
        (Counter, {"reward": 1e30}, {}, "gradient of the loss is not finite in batch 1"),
    ],
)
def test_unusable_environments_and_settings_are_refused(environment, arguments, changes, sentence):
    with pytest.raises(TrainingError, match=sentence):
        train(vectorize(environment, **arguments), replace(SMALL, **changes), seed=0, metadata={})


def test_exploration_fades_as_scheduled():
    reports = []
    settings = replace(SMALL, batches=4, initial_std=0.4, final_std=0.1)
    train(vectorize(Tracker), settings, seed=0, metadata={}, on_batch=reports.append)
    np.testing.assert_allclose([r.std for r in reports], 0.4 * 0.25 ** np.array([0.0, 0.25, 0.5, 0.75]), rtol=1e-5)


def test_the_learning_rate_holds_the_divergence():
    """The first rate is a hundred times too high, then a hundred times too low."""
    for learning_rate in (1e-1, 1e-5):
        reports = []
        settings = replace(SMALL, batches=60, learning_rate=learning_rate, target_kl=0.01)
        train(vectorize(Tracker), settings, seed=0, metadata={}, on_batch=reports.append)
        late = np.median([report.approx_kl for report in reports[30:]])
        assert 0.003 < late < 0.03


@pytest.mark.parametrize("seed", [-1, 2**32, 2**70])
def test_an_impossible_seed_is_refused(seed):
    with pytest.raises(TrainingError, match="expected a whole number from 0"):
        train(vectorize(Counter), SMALL, seed=seed, metadata={})


def test_on_batch_can_end_the_training(tmp_path):
    """The policy is that after the batch, and the files are written; paths may be texts."""
    files = {"log_path": str(tmp_path / "log.csv"), "checkpoint_path": str(tmp_path / "policy.safetensors")}
    policy = train(vectorize(Tracker), SMALL, seed=0, on_batch=lambda report: report.batch < 2, **files)
    observation = np.array([0.1, 0.2])
    np.testing.assert_array_equal(
        Policy.load(tmp_path / "policy.safetensors").act(observation), policy.act(observation)
    )
    assert len((tmp_path / "log.csv").read_text().splitlines()) == 1 + 2
    assert (train(vectorize(Tracker), SMALL, seed=0).act(observation) != policy.act(observation)).any()


def test_a_training_can_start_from_a_policy():
    """While only the critic learns, the actor is that of the policy: weights and scaling of inputs fit each other."""
    first = train(vectorize(Tracker), SMALL, seed=0)
    observation = np.random.default_rng(0).normal(size=(20, 2))
    settings = replace(SMALL, batches=1, critic_share=1.0, critic_learning_rate=1e-9)
    warm = train(vectorize(Tracker), settings, seed=5, initial_policy=first)
    np.testing.assert_allclose(warm.act(observation), first.act(observation), atol=1e-5)
    np.testing.assert_allclose(warm.value(observation), first.value(observation), atol=1e-4)
    with pytest.raises(TrainingError, match=r"The actor of the initial policy has the weights .*\(16, 2\): expected"):
        train(vectorize(Tracker), replace(settings, actor_layers=(8,)), seed=5, initial_policy=first)
    with pytest.raises(TrainingError, match=r"observations and actions of the shapes \(2,\) .*: expected \(1,\)"):
        train(vectorize(Counter), settings, seed=5, initial_policy=first)


def test_other_things_than_vector_environments_are_refused():
    with pytest.raises(TrainingError, match=r"PPO needs a vector environment, .* was given Tracker"):
        train(Tracker(), SMALL, seed=0)


def test_imitation_without_tasks_is_refused():
    with pytest.raises(TrainingError, match="ask for 4 rounds of imitation, but SyncVectorEnv has no tasks"):
        train(vectorize(Tracker), replace(SMALL, imitation_rounds=4), seed=0)
