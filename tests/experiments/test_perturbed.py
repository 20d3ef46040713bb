"""Perturbed runs of a policy: seeded, each with noise of its own, and chosen in a scenario file."""

import numpy as np
import pytest
import torch
import yaml

from drakearm.diagrams import MotorNoise, StartNoise
from drakearm.errors import PolicyFileError, ScenarioError
from drakearm.experiments import load_scenario, run_policy_perturbed, scenario_files
from drakearm.learning.networks import Actor, Critic, policy_of

NOISE = (StartNoise(posture_deg=2.0, activation=0.05), MotorNoise(0.2))


def make_policy(n_observations):
    generator = torch.Generator().manual_seed(0)
    actor = Actor(n_observations, 14, (8,), generator=generator)
    return policy_of(actor, Critic(n_observations, (8,), generator=generator), np.zeros(14), np.ones(14), {})


def test_each_run_has_noise_of_its_own_and_the_seed_determines_all(task):
    policy = make_policy(task.observation.size)
    runs = run_policy_perturbed(task, policy, NOISE, seed=1, runs=2)
    again = run_policy_perturbed(task, policy, NOISE, seed=1, runs=2)
    other = run_policy_perturbed(task, policy, NOISE, seed=2, runs=1)
    assert len(runs) == 2
    for one, same in zip(runs, again, strict=True):
        np.testing.assert_array_equal(one.q, same.q)
    assert len({run.q[-1].tobytes() for run in (*runs, *other)}) == 3


def test_a_policy_for_other_observations_is_refused(task):
    with pytest.raises(PolicyFileError, match="observations of length 3"):
        run_policy_perturbed(task, make_policy(3), NOISE, seed=0, runs=1)


@pytest.mark.parametrize("name", ["timing-0.4s", "timing-0.5s", "timing-0.6s", "timing-0.7s"])
def test_the_timing_scenarios_perturb_start_and_excitations(name):
    """As the paper does: start posture, initial activation and excitation."""
    assert load_scenario(name).perturbations == NOISE


def test_a_wrong_perturbation_is_named(tmp_path):
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    fields["perturbations"][1]["share"] = -1
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump(fields))
    with pytest.raises(ScenarioError, match=r"mine.yaml: perturbations.1.motor_noise.share: found -1, expected"):
        load_scenario(file)
