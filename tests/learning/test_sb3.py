"""Stable-Baselines3 on ArmVectorEnv: the same transitions, its own algorithms learn, and clear refusals."""

import logging

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.vec_env.base_vec_env import VecEnv

from drakearm.errors import TrainingError
from drakearm.learning import ArmVectorEnv
from drakearm.learning.sb3 import Sb3VecEnv

ARMS = 3


@pytest.fixture(autouse=True)
def one_thread():
    torch.set_num_threads(1)


def test_transitions_are_those_of_the_vector_environment(task):
    ours, theirs = ArmVectorEnv(task, ARMS), Sb3VecEnv(ArmVectorEnv(task, ARMS))
    assert isinstance(theirs, VecEnv)
    theirs.seed(7)
    observation, _ = ours.reset(seed=7)
    np.testing.assert_array_equal(theirs.reset(), observation)
    rng, steps, total = np.random.default_rng(0), len(task.reference.t) - 1, np.zeros(ARMS)
    for step in range(steps + 3):
        action = rng.random((ARMS, 14)).astype(np.float32)
        observation, reward, _, truncated, info = ours.step(action)
        found, rewards, done, infos = theirs.step(action)
        np.testing.assert_array_equal(found, observation)
        np.testing.assert_allclose(rewards, reward, rtol=1e-6)
        np.testing.assert_array_equal(done, truncated)
        total += reward
        if step == steps - 1:
            assert done.all()
            for i in range(ARMS):
                np.testing.assert_array_equal(infos[i]["terminal_observation"], info["final_obs"][i])
                assert infos[i]["TimeLimit.truncated"] is True
                assert infos[i]["episode"] == {"r": pytest.approx(total[i]), "l": steps}
        else:
            assert infos == [{}] * ARMS


@pytest.mark.parametrize(
    ("algorithm", "settings"),
    [(PPO, {"n_steps": 20, "batch_size": 30}), (SAC, {"learning_starts": 10, "batch_size": 16, "train_freq": 5})],
)
def test_their_algorithms_update_a_policy(task, algorithm, settings):
    model = algorithm("MlpPolicy", Sb3VecEnv(ArmVectorEnv(task, ARMS)), seed=0, device="cpu", **settings)
    before = {name: value.clone() for name, value in model.policy.named_parameters()}
    model.learn(300)
    assert model.num_timesteps >= 300 and len(model.ep_info_buffer) > 0
    changed = [name for name, value in model.policy.named_parameters() if not torch.equal(before[name], value)]
    assert changed
    action, _ = model.predict(model.env.reset(), deterministic=True)
    assert action.shape == (ARMS, 14) and (action >= 0.0).all() and (action <= 1.0).all()


def test_several_threads_are_a_warning(task, caplog):
    torch.set_num_threads(2)
    with caplog.at_level(logging.WARNING, "drakearm"):
        Sb3VecEnv(ArmVectorEnv(task, 1))
    assert "torch.set_num_threads(1)" in caplog.text


def test_what_single_arms_do_not_have_is_refused(task):
    envs = Sb3VecEnv(ArmVectorEnv(task, 2))
    assert envs.get_attr("num_envs", indices=[1]) == [2] and envs.env_is_wrapped(object) == [False, False]
    with pytest.raises(TrainingError, match="load cannot be set"):
        envs.set_attr("load", 1.0)
    with pytest.raises(TrainingError, match="no method push"):
        envs.env_method("push")
    with pytest.raises(AttributeError, match="nothing"):
        envs.get_attr("nothing")
