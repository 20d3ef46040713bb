"""Gymnasium environments that are small, with known solutions, for tests of learning."""

import math

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, SyncVectorEnv

NEXT_STEP, SAME_STEP = AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP


class Counter(gymnasium.Env):
    """Observes the number of steps so far; the reward is 1 per step; an episode has `length` steps."""

    observation_space = Box(-np.inf, np.inf, (1,), np.float64)
    action_space: gymnasium.Space = Box(-1.0, 1.0, (1,), np.float64)

    def __init__(self, length=5, terminates=False, reward=1.0):
        self.length, self.terminates, self.reward = length, terminates, reward

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.count = 0
        return np.zeros(1), {}

    def step(self, action):
        assert self.action_space.contains(action)
        self.count += 1
        end = self.count == self.length
        observation = np.array([float(self.count)])
        return observation, self.reward, end and self.terminates, end and not self.terminates, {}


class Tracker(gymnasium.Env):
    """A point that moves by its action and should follow a sine. An episode is truncated after 20 steps.

    Observes position and target. The best action is their difference; its reward is 0.
    """

    observation_space = Box(-np.inf, np.inf, (2,), np.float32)
    action_space = Box(-1.0, 1.0, (1,), np.float32)

    def _observation(self):
        self.target = math.sin(self.phase + 0.3 * self.count)
        return np.array([self.position, self.target], dtype=np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.phase = self.np_random.uniform(0, 2 * math.pi)
        self.count = 0
        self.position = math.sin(self.phase)
        return self._observation(), {}

    def step(self, action):
        self.position += float(action[0])
        error = self.target - self.position
        self.count += 1
        info = {"tracking_error": np.array([error, -error])}
        return self._observation(), -(error**2), False, self.count == 20, info


def tracking_return(policy):
    """The mean return of a policy in fresh episodes of Tracker: at most 0; standing still earns about -20."""
    envs = vectorize(Tracker, n=32, mode=SAME_STEP)
    observation, _ = envs.reset(seed=99)
    rewards = []
    for _ in range(20):
        observation, reward, *_ = envs.step(policy.act(observation))
        rewards.append(reward)
    return np.mean(np.sum(rewards, axis=0))


def vectorize(environment, n=4, mode=NEXT_STEP, **arguments):
    return SyncVectorEnv([lambda: environment(**arguments)] * n, autoreset_mode=mode)
