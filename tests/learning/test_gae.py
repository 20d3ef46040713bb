"""Generalized advantage estimates equal their definition, computed for each step of each trajectory."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drakearm.learning.rollout import gae


def slow_advantage(t, n, rewards, values, next_values, terminated, ended, gamma, lam):
    """The discounted sum of temporal differences from step t on, until the trajectory ends."""
    total = 0.0
    for k in range(t, len(rewards)):
        future = 0.0 if terminated[k, n] else gamma * next_values[k, n]
        total += (gamma * lam) ** (k - t) * (rewards[k, n] + future - values[k, n])
        if ended[k, n]:
            break
    return total


@given(
    seed=st.integers(0, 2**32 - 1),
    T=st.integers(1, 12),
    N=st.integers(1, 4),
    gamma=st.floats(0.0, 1.0),
    lam=st.floats(0.0, 1.0),
    p_end=st.floats(0.0, 1.0),
)
def test_equals_the_definition(seed, T, N, gamma, lam, p_end):
    rng = np.random.default_rng(seed)
    rewards, values, next_values = rng.normal(size=(3, T, N))
    ended = rng.random((T, N)) < p_end
    terminated = ended & (rng.random((T, N)) < 0.5)
    arguments = (rewards, values, next_values, terminated, ended, gamma, lam)
    expected = [[slow_advantage(t, n, *arguments) for n in range(N)] for t in range(T)]
    np.testing.assert_allclose(gae(*arguments), expected, atol=1e-12)


def test_lambda_one_is_the_return_minus_the_value():
    rewards, values = np.ones((3, 1)), np.full((3, 1), 0.5)
    end = np.array([[False], [False], [True]])
    advantages = gae(rewards, values, np.full((3, 1), 0.5), end, end, gamma=0.5, lam=1.0)
    np.testing.assert_allclose(advantages[:, 0], [1.75 - 0.5, 1.5 - 0.5, 1.0 - 0.5])


@pytest.mark.parametrize(("terminates", "expected"), [(True, 1.0), (False, 1.0 + 0.9 * 10.0)])
def test_only_truncation_bootstraps(terminates, expected):
    one = np.ones((1, 1))
    end = np.array([[True]])
    advantages = gae(one, 0 * one, 10 * one, end & terminates, end, gamma=0.9, lam=0.95)
    np.testing.assert_allclose(advantages, [[expected]])
