"""The same seed gives the same result, bit for bit, with a cold or warm cache and any number of threads."""

import os
import subprocess
import sys

import numpy as np
import pytest
import torch

from drakearm.learning import Policy
from drakearm.learning.backprop import Backprop, flat_weights
from drakearm.learning.networks import Actor, Critic, policy_of

# Plans, imitates and trains briefly, and prints hashes of the results.
WHOLE_RUN = """
import hashlib
from dataclasses import replace
from drakearm.experiments.scenario import load_scenario
from drakearm.learning import ArmVectorEnv, PpoSettings, imitate, train
from drakearm.model import load_arm
from drakearm.planning import plan

scenario = load_scenario("obstacle")
reference = plan(load_arm("arm14"), scenario.movement, obstacle=scenario.obstacle).reference
task = scenario.task(reference)
policy = train(
    ArmVectorEnv(task, 8),
    PpoSettings(batches=2, environments=8, minibatches=2),
    seed=3,
    metadata={},
    prepare=lambda actor: imitate(actor, [task], rounds=2, seed=3),
)
for arrays in ([reference.q, reference.tau], list(policy.weights.values())):
    print(hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest())
"""


def run_with_cache(folder, one_core=False) -> list[str]:
    """What WHOLE_RUN prints in a new process, with Numba's cache in a folder."""
    threads = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    environment = os.environ | {"NUMBA_CACHE_DIR": str(folder)} | (threads if one_core else {})
    start = "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n" if one_core else ""
    command = [sys.executable, "-c", start + WHOLE_RUN]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.split()


@pytest.mark.slow
@pytest.mark.extra
@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system cannot keep a process on one core")
def test_a_cold_and_a_warm_cache_and_one_and_more_threads_give_the_same_policy(tmp_path):
    cold = run_with_cache(tmp_path)
    assert len(cold) == 2
    assert run_with_cache(tmp_path, one_core=True) == cold  # now with a warm cache


@pytest.mark.parametrize("layers", [(64, 64), (63, 17), (5, 3, 7)])
def test_a_policy_acts_as_the_loaded_one_after_its_weights_were_flat(layers, tmp_path):
    actor, critic = Actor(29, 14, layers), Critic(29, (31,))
    flat_weights(actor)
    flat_weights(critic)
    policy = policy_of(actor, critic, np.zeros(14), np.ones(14), {})
    policy.save(tmp_path / "policy.safetensors")
    loaded = Policy.load(tmp_path / "policy.safetensors")
    for observation in np.random.default_rng(0).standard_normal((200, 29)):
        np.testing.assert_array_equal(loaded.act(observation), policy.act(observation))


def test_flat_weights_are_aligned_like_separate_tensors():
    """Matrix products round differently at other addresses."""
    actor = Actor(29, 14, (63, 17))
    before = [parameter.detach().clone() for parameter in actor.parameters()]
    flat = flat_weights(actor)
    assert flat.grad is not None
    for parameter, value in zip(actor.parameters(), before, strict=True):
        assert parameter.data_ptr() % 64 == 0
        assert parameter.grad is not None and parameter.grad.data_ptr() % 64 == 0
        assert torch.equal(parameter, value)
    backprop = Backprop(actor.mean)
    backprop.forward(torch.ones(5, 29))
    backprop.backward(torch.ones(5, 14))
    written = sum(int(parameter.grad.count_nonzero()) for parameter in actor.parameters())
    assert int(flat.grad.count_nonzero()) == written > 0  # the gradient between the views stays 0
