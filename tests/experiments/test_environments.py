"""The environments as Gymnasium makes them: one Diagram, or many compiled arms, of one scenario or several."""

import warnings

import gymnasium
import numpy as np
import pytest

from drakearm.errors import ScenarioError
from drakearm.experiments import scenario_files
from drakearm.learning import ArmVectorEnv


def make_vec(**kwargs):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return gymnasium.make_vec("drakearm/Track-v0", **kwargs)


def test_make_vec_makes_compiled_arms():
    envs = make_vec(num_envs=3, scenario="timing-0.7s")
    assert type(envs) is ArmVectorEnv
    assert envs.num_envs == 3
    observation, _ = envs.reset(seed=4)
    assert envs.observation_space.contains(observation)
    single = gymnasium.make("drakearm/Track-v0", scenario="timing-0.7s")
    np.testing.assert_allclose(observation[2], single.reset(seed=6)[0], rtol=1e-6, atol=1e-7)


def test_make_vec_mixes_scenarios_by_name_and_file():
    scenarios = ["timing-0.4s", scenario_files()["lift-5kg"]]
    envs = make_vec(num_envs=4, scenario=scenarios)
    observation, _ = envs.reset(seed=0)
    for i in range(4):
        single = gymnasium.make("drakearm/Track-v0", scenario=scenarios[i % 2])
        np.testing.assert_allclose(observation[i], single.reset(seed=i)[0], rtol=1e-6, atol=1e-7)


def test_make_vec_can_still_make_diagrams():
    envs = make_vec(num_envs=2, scenario="timing-0.7s", vectorization_mode="sync")
    assert isinstance(envs, gymnasium.vector.SyncVectorEnv)


def test_an_unknown_scenario_among_several_is_named():
    with pytest.raises(ScenarioError, match="no scenario 'dancing'"):
        make_vec(num_envs=2, scenario=["timing-0.7s", "dancing"])
