"""The shipped policies of the repertoires are as exact as the documentation says, in movements never seen."""

import numpy as np
import pytest

from drakearm.experiments.environments import scenario_task
from drakearm.planning import plan_library
from drakearm.repertoire import held_out_errors, load_repertoire, repertoire_files
from drakearm.repertoire.shipped import shipped_errors, shipped_policy
from tests.shipped import PAPER

FRESH = 20261129  # a seed with which nothing was trained or chosen
HEAVY = ("lift-5kg", "lift-10kg", "lift-20kg")
LIGHT = [name for name in PAPER if not name.startswith(HEAVY)]


@pytest.mark.parametrize("name", repertoire_files())
def test_every_repertoire_has_a_policy_that_fits_it(name, arm):
    errors, repertoire, policy = shipped_errors(name), load_repertoire(name), shipped_policy(name)
    assert errors["repertoire"] == policy.metadata["repertoire"] == name
    movements = repertoire.movements
    tasks = repertoire.tasks(plan_library(arm, movements.source, 12, FRESH))
    policy.check(tasks[0])
    found = held_out_errors(tasks, policy.act)
    assert np.median(found.mean) < 0.01 and np.median(found.hand) < 0.4


@pytest.mark.slow
def test_reaches_over_the_whole_workspace_with_loads_that_the_policy_is_not_told(arm):
    repertoire, policy = load_repertoire("reaching"), shipped_policy("reaching")
    anywhere = repertoire.movements.source.sources[0]
    assert anywhere.load_mass == (0.0, 2.0) and anywhere.duration == (0.4, 1.0)
    errors = held_out_errors(repertoire.tasks(plan_library(arm, anywhere, 60, FRESH)), policy.act)
    assert np.median(errors.mean) <= 0.008 and np.percentile(errors.mean, 95) <= 0.02
    assert np.median(errors.hand) <= 0.4 and np.percentile(errors.hand, 95) <= 1.0


def test_the_shipped_movements(arm):
    """None of them was trained. The policy is not told the load."""
    repertoire, policy = load_repertoire("reaching"), shipped_policy("reaching")
    tasks = [scenario_task(name) for name in LIGHT]
    errors = held_out_errors([repertoire.task(task.reference, task.load_mass) for task in tasks], policy.act)
    for name, error in zip(LIGHT, errors.mean, strict=True):
        assert error <= (0.008 if name.startswith("reach") else 0.015), f"{name}: {error:.4f} rad"
