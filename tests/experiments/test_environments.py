"""The environments as Gymnasium makes them: one Diagram, or many compiled arms, for one scenario or several."""

import re
import subprocess
import sys
import warnings
from collections import defaultdict
from dataclasses import replace
from functools import partial

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv
from stable_baselines3.common.vec_env import SubprocVecEnv

from drakearm.errors import ScenarioError
from drakearm.experiments import scenario_files
from drakearm.experiments.choices import EnvKind
from drakearm.experiments.environments import make_env, make_task_env, make_training_envs
from drakearm.experiments.scenario import load_scenario
from drakearm.learning import ArmVectorEnv
from drakearm.task import OBSERVATIONS


def make_vec(**kwargs):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return gymnasium.make_vec("drakearm/Track-v0", **kwargs)


def test_a_changed_scenario_file_is_planned_again(tmp_path):
    """Also in the same process: a notebook changes a file and makes the environment anew."""
    file = tmp_path / "mine.yaml"
    steps = []
    for name in ("timing-0.4s", "timing-0.7s"):
        file.write_text(scenario_files()[name].read_text())
        steps.append(gymnasium.make("drakearm/Track-v0", scenario=file).spec.max_episode_steps)
    assert steps[0] < steps[1]


def test_an_environment_imports_only_what_it_needs():
    """Each of these takes 0.1 s or more, and a program waits for its first environment."""
    code = """
import sys, gymnasium, drakearm
env = gymnasium.make("drakearm/Track-v0", scenario="reach-000")
env.reset(seed=0)
env.step(env.action_space.sample())
print(*{"joblib", "matplotlib", "scipy.interpolate", "scipy.optimize", "torch"} & set(sys.modules))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == ""


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
    assert isinstance(envs, SyncVectorEnv)


@pytest.mark.slow
@pytest.mark.parametrize("processes", ["Gymnasium", "Stable-Baselines3"])
def test_new_processes_make_the_same_environments(reference, processes):
    """They share nothing with this one (spawn): what makes an environment is pickled, not the environment."""
    factories = [partial(make_env, "timing-0.7s", reference)] * 2
    action = np.random.default_rng(0).random((2, 14)).astype(np.float32)
    here = SyncVectorEnv(factories)
    first, _ = here.reset(seed=3)
    second, reward, *_ = here.step(action)
    if processes == "Gymnasium":
        there = AsyncVectorEnv(factories, context="spawn")
        found_first, _ = there.reset(seed=3)
        found_second, found_reward, *_ = there.step(action)
    else:
        there = SubprocVecEnv(factories, start_method="spawn")
        there.seed(3)
        found_first = there.reset()
        found_second, found_reward, *_ = there.step(action)
    there.close()
    np.testing.assert_array_equal(found_first, first)
    np.testing.assert_array_equal(found_second, second)
    np.testing.assert_allclose(found_reward, reward, rtol=1e-15)


def test_environments_for_training_step_diagrams_in_processes(task):
    ours = make_training_envs([task], 3, EnvKind.diagram)
    theirs = SyncVectorEnv([partial(make_task_env, task)] * 3, autoreset_mode=AutoresetMode.SAME_STEP)
    np.testing.assert_array_equal(ours.reset(seed=1)[0], theirs.reset(seed=1)[0])
    rng = np.random.default_rng(0)
    for _ in range(len(task.reference.t) + 3):
        action = rng.random((3, 14)).astype(np.float32)
        found, expected = ours.step(action), theirs.step(action)
        for i in range(4):
            np.testing.assert_array_equal(found[i], expected[i])
    for name in ("arm_state", "tracking_error", "activation"):
        np.testing.assert_array_equal(found[4][name], expected[4][name])
    ours.close()


def test_an_unknown_scenario_among_several_is_named():
    with pytest.raises(ScenarioError, match="no scenario 'dancing'"):
        make_vec(num_envs=2, scenario=["timing-0.7s", "dancing"])


def indices(cell):
    """The indices that a cell of a table names, such as 3 or 0-13."""
    first, _, last = cell.partition("-")
    return list(range(int(first), int(last or first) + 1))


def observation_table():
    """The rows of the observation in the docstring of `make_env`: indices, sense, observation, min, max, unit."""
    rows = re.findall(r"^ *\| *([\d-]+) *\| `(\w+)` *\|(.*)\|$", make_env.__doc__, re.MULTILINE)
    return [(indices(cell), sense, *map(str.strip, rest.split("|"))) for cell, sense, rest in rows]


def test_the_documented_observation_is_the_tasks(reference):
    task = load_scenario("timing-0.7s").task(reference)
    documented = defaultdict(list)
    for elements, sense, *_ in observation_table():
        documented[sense] += elements
    places = {sense: list(range(place.start, place.stop)) for sense, place in task.observation.places.items()}
    assert documented == places
    assert f"({task.observation.size},), float32)` with the set `full`" in make_env.__doc__
    paper = replace(task, senses=OBSERVATIONS["paper"]).observation
    assert list(paper.places.items()) == list(task.observation.places.items())[:2]
    assert f"({paper.size},), float32)` and has only the first two rows" in make_env.__doc__


def test_the_documented_muscles_and_limits_are_those_of_the_arm(reference):
    muscles = re.search(r"in\s+this order: ([\w,\s]+)\.", make_env.__doc__).group(1)
    task = load_scenario("timing-0.7s").task(reference)
    assert re.split(r",\s+", muscles) == [muscle.name for muscle in task.arm.muscles]
    env = make_env("timing-0.7s", reference)
    env.reset(seed=0)
    rng = np.random.default_rng(0)
    observations = np.array([env.step(rng.random(14))[0] for _ in range(30)])
    for elements, sense, _, low, high, _ in observation_table():
        beyond = 0.1 if sense == "arm_state" else 1e-6  # rad, in the elastic stops; rounding
        assert (observations[:, elements] >= float(low) - beyond).all()
        assert (observations[:, elements] <= float(high) + beyond).all()
