"""ArmVectorEnv: the same arm as DiagramEnv, many times; Gymnasium's contract for vector environments."""

from dataclasses import replace

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from drakearm.diagrams import MakeTrackingTask
from drakearm.errors import ActionError
from drakearm.learning import ArmVectorEnv, DiagramEnv
from drakearm.model.reference import CONTROL_STEP


def diagram_env(task):
    diagram, systems = MakeTrackingTask(task)
    return DiagramEnv(diagram, systems.Reset, control_step=CONTROL_STEP, episode_steps=len(task.reference.t) - 1)


@pytest.mark.parametrize("observation", ["paper", "full"])
@pytest.mark.parametrize("load", [0.0, 5.0])
def test_parity_with_the_diagram(task, observation, load):
    """Whole episodes of two environments: state, observation and reward agree to 1e-8, at every step."""
    task = replace(task, observation=observation, load_mass=load)
    many, seed = ArmVectorEnv(task, 2), 5
    rng = np.random.default_rng(seed)
    actions = rng.random((75, 2, 14)) ** 3
    observations, _ = many.reset(seed=seed)
    singles = [diagram_env(task) for _ in range(2)]
    for i, single in enumerate(singles):
        first, _ = single.reset(seed=seed + i)
        np.testing.assert_allclose(observations[i], first, atol=1e-7, err_msg="first observation")
    for k in range(75):
        observations, rewards, _, truncated, info = many.step(actions[k])
        if truncated.any():
            observations = info["final_obs"]
        for i, single in enumerate(singles):
            one, reward, _, over, one_info = single.step(actions[k, i])
            where = f"at step {k} of environment {i}"
            np.testing.assert_allclose(
                info["arm_state"][i], one_info["arm_state"], rtol=1e-8, atol=1e-8, err_msg=f"arm_state {where}"
            )
            np.testing.assert_allclose(
                info["activation"][i], one_info["activation"], atol=1e-8, err_msg=f"activation {where}"
            )
            np.testing.assert_allclose(rewards[i], reward, rtol=1e-8, atol=1e-8, err_msg=f"reward {where}")
            np.testing.assert_allclose(
                observations[i],
                one,
                rtol=1e-6,
                atol=1e-7,
                err_msg=f"observation {where}",  # float32
            )
            assert truncated[i] == over


def test_it_resets_itself_in_the_same_step(task):
    envs = ArmVectorEnv(task, 3)
    assert envs.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP
    envs.reset(seed=0)
    for _ in range(74):
        *_, truncated, _ = envs.step(np.full((3, 14), 0.1))
        assert not truncated.any()
    observation, _, terminated, truncated, info = envs.step(np.full((3, 14), 0.1))
    assert truncated.all() and not terminated.any()
    assert np.abs(info["final_obs"] - observation).max() > 0.5  # the end of one episode, the start of the next
    assert np.abs(info["tracking_error"]).max() > 0.3  # of the transition, not of the new start
    np.testing.assert_allclose(observation[:, 28:42], 0.05)  # resting activations


def test_seeds_repeat_and_differ_between_environments(task):
    envs = ArmVectorEnv(task, 2)
    first, _ = envs.reset(seed=7)
    again, _ = envs.reset(seed=7)
    np.testing.assert_array_equal(first, again)
    assert (first[0] != first[1]).any()


@pytest.mark.parametrize("actions", [np.full((2, 14), np.nan), np.zeros((3, 14)), np.zeros(14)])
def test_unusable_actions_are_refused(task, actions):
    envs = ArmVectorEnv(task, 2)
    envs.reset(seed=0)
    with pytest.raises(ActionError, match="2 times 14 finite"):
        envs.step(actions)


@pytest.mark.slow
@pytest.mark.parametrize("load", [0.0, 20.0])
def test_random_episodes_stay_finite(task, load):
    """1000 episodes of 75 random actions, from noisy starts: no NaN, no exception."""
    envs = ArmVectorEnv(replace(task, load_mass=load, start_noise=0.2), 500)
    rng = np.random.default_rng(0)
    envs.reset(seed=0)
    for _ in range(2 * 75):
        observation, reward, *_, info = envs.step(rng.random((500, 14)))
        assert np.isfinite(observation).all() and np.isfinite(reward).all()
        assert np.abs(info["arm_state"]).max() < 100.0
