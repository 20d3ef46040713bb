"""skrl on ArmVectorEnv: its PPO learns, and bootstraps truncated episodes from their last observations."""

import numpy as np
import pytest
import torch
from skrl.agents.torch.ppo import PPO, PPO_CFG
from skrl.agents.torch.sac import SAC, SAC_CFG
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.trainers.torch import SequentialTrainer, SequentialTrainerCfg
from skrl.utils.model_instantiators.torch import deterministic_model, gaussian_model

from drakearm.learning import ArmVectorEnv
from drakearm.learning.skrl import FinalObservations

ARMS = 3
DISCOUNT = 0.9
LAYERS = [{"name": "net", "input": "OBSERVATIONS", "layers": [16], "activations": "tanh"}]


class ArmPPO(FinalObservations, PPO):
    pass


class ArmSAC(FinalObservations, SAC):
    pass


@pytest.fixture(autouse=True)
def one_thread():
    torch.set_num_threads(1)
    torch.manual_seed(0)


class Recorded(ArmVectorEnv):
    """Keeps what it returned in each step."""

    def step(self, actions):
        self.steps = [*getattr(self, "steps", []), super().step(actions)]
        return self.steps[-1]


@pytest.fixture
def env(task):
    return wrap_env(Recorded(task, ARMS), wrapper="gymnasium", verbose=False)


def make_agent(agent, env, settings, steps, critics=("value",)):
    settings.experiment.write_interval = settings.experiment.checkpoint_interval = 0
    spaces = {"observation_space": env.observation_space, "action_space": env.action_space, "device": "cpu"}
    actor = gaussian_model(**spaces, clip_actions=True, initial_log_std=-1.6, network=LAYERS, output="ACTIONS")
    models = {"policy": actor} | {name: deterministic_model(**spaces, network=LAYERS, output="ONE") for name in critics}
    for name, model in models.items():
        model.init_state_dict(role=name)
    memory = RandomMemory(memory_size=steps, num_envs=ARMS, device="cpu")
    return agent(models=models, memory=memory, cfg=settings, **spaces)


def learn(agent, env, steps):
    cfg = SequentialTrainerCfg(
        timesteps=steps, headless=True, disable_progressbar=True, close_environment_at_exit=False
    )
    SequentialTrainer(env=env, agents=agent, cfg=cfg).train()


def test_its_ppo_updates_the_policy(env):
    settings = PPO_CFG(rollouts=20, mini_batches=2, learning_epochs=2, time_limit_bootstrap=True)
    agent = make_agent(ArmPPO, env, settings, 20)
    before = [value.detach().clone() for value in agent.policy.parameters()]
    learn(agent, env, 80)  # the episodes have 75 steps
    after = list(agent.policy.parameters())
    assert all(torch.isfinite(value).all() for value in after)
    assert any(not torch.equal(old, new) for old, new in zip(before, after, strict=True))
    actions, _ = agent.act(env.reset()[0], None, timestep=0, timesteps=1)
    assert actions.shape == (ARMS, 14) and (actions >= 0.0).all() and (actions <= 1.0).all()


def test_a_truncated_episode_is_bootstrapped_from_its_last_observation(env):
    settings = PPO_CFG(rollouts=1000, discount_factor=DISCOUNT, time_limit_bootstrap=True)  # it only collects
    agent = make_agent(ArmPPO, env, settings, 80)
    learn(agent, env, 80)
    stored = agent.memory.get_tensor_by_name
    for step, (_, reward, _, truncated, info) in enumerate(env.unwrapped.steps):
        expected = torch.as_tensor(reward, dtype=torch.float32)[:, None]
        if step == 74:
            with torch.no_grad():
                value, _ = agent.value.act({"observations": torch.tensor(info["final_obs"])})
            expected = expected + DISCOUNT * value
        torch.testing.assert_close(stored("rewards")[step], expected)
        assert truncated.all() == stored("truncated")[step].all() == (step == 74)


def test_an_off_policy_agent_stores_the_last_observation(env):
    critics = ("critic_1", "critic_2", "target_critic_1", "target_critic_2")
    settings = SAC_CFG(learning_starts=1000, random_timesteps=1000)  # it only collects
    agent = make_agent(ArmSAC, env, settings, 80, critics)
    learn(agent, env, 80)
    stored = agent.memory.get_tensor_by_name
    for step, (following, *_, info) in enumerate(env.unwrapped.steps):
        expected = info["final_obs"] if step == 74 else following
        np.testing.assert_array_equal(stored("next_observations")[step].numpy(), expected)
        if step < 79:  # the agent acts on what the environment returned
            np.testing.assert_array_equal(stored("observations")[step + 1].numpy(), following)
