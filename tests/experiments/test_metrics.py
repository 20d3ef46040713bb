"""What drives an arm in `run_policy`: a policy, or any function of the observation."""

import numpy as np
import pytest

from drakearm.errors import TaskError
from drakearm.experiments import run_policy, run_policy_perturbed, run_policy_stochastic


def constant(observation):
    return np.full(14, 0.1)


def test_a_function_can_drive_the_arm(task):
    recording = run_policy(task, constant)
    assert recording.activation[-1] == pytest.approx(0.1, rel=0.05)
    assert len(run_policy_perturbed(task, constant, (), seed=0, runs=1)) == 1


def test_what_is_no_policy_is_refused(task):
    with pytest.raises(TaskError, match="Found the policy 'best': expected a Policy, or a function"):
        run_policy(task, "best")
    with pytest.raises(TaskError, match="expected a Policy, which can sample"):
        run_policy_stochastic(task, constant, seed=0)
