"""`drakearm evaluate` with perturbations: its results lie beside the run's own, and say what they were made from."""

import shutil

import numpy as np
import pytest

from drakearm.experiments import RunFolder
from drakearm.experiments.provenance import fingerprint
from drakearm.learning import Policy
from drakearm.model import Recording
from tests.cli.command import RUN_FILES, contents, drakearm

PERTURBED = {"perturbed.json", "perturbed.npz"}


@pytest.fixture(scope="module")
def perturbed(finished, tiny, tmp_path_factory):
    """A finished run that was evaluated with a load and a push, what was in the folder before, and what was printed."""
    run = RunFolder(tmp_path_factory.mktemp("perturbed") / "run")
    shutil.copytree(finished[0], run.folder)
    before = contents(run)
    return run, before, drakearm("evaluate", tiny, "--out", run.folder, "--load", 1, "--push", "-2,0.3,0.1")


@pytest.fixture
def run(perturbed, tmp_path):
    shutil.copytree(perturbed[0].folder, tmp_path / "run")
    return RunFolder(tmp_path / "run")


def test_the_runs_own_files_stay(perturbed):
    run, before, printed = perturbed
    after = contents(run)
    assert set(after) == RUN_FILES | PERTURBED and {name: after[name] for name in before} == before
    for part in ("extra load", "mass 1.0", "push", "torque -2.0, start 0.3, duration 0.1", "10 runs", "mean error"):
        assert part in printed, part


def test_the_results_are_those_of_the_perturbed_arm(perturbed):
    run = perturbed[0]
    metrics, own = run.read_json("perturbed", "evaluate"), run.read_json("metrics", "evaluate")
    assert metrics["perturbations"] == [
        {"type": "extra_load", "mass": 1.0},
        {"type": "push", "torque": -2.0, "start": 0.3, "duration": 0.1},
    ]
    recording = Recording.load(run.path("perturbed_recording"))
    error = np.abs(recording.q - recording.reference_q).mean(axis=0)
    np.testing.assert_allclose(metrics["perturbed"]["tracking_error_mean"][0], error)
    assert error[1] > 2.0 * own["noise_free"]["tracking_error_mean"][1]


def test_they_are_replaced_only_if_asked(run, tiny):
    before = contents(run)
    assert "perturbed.json exists already" in drakearm("evaluate", tiny, "--out", run.folder, "--strength", 0.8, code=1)
    assert contents(run) == before
    drakearm("evaluate", tiny, "--out", run.folder, "--strength", 0.8, "--overwrite")
    assert run.read_json("perturbed", "evaluate")["perturbations"] == [{"type": "strength", "factor": 0.8}]


def test_a_new_evaluation_keeps_them_and_a_new_training_removes_them(run, tiny):
    before = contents(run)
    drakearm("evaluate", tiny, "--out", run.folder, "--overwrite")
    assert {name: contents(run)[name] for name in PERTURBED} == {name: before[name] for name in PERTURBED}
    for step in ("train", "plan"):
        assert PERTURBED <= {file.name for file in run.claim(step, overwrite=True)}


def test_another_policy_needs_no_training(run, tiny, tmp_path):
    """In a folder with only a plan. It is recorded which policy it was, and that the run had none of its own."""
    other = RunFolder(tmp_path / "other")
    drakearm("plan", tiny, "--out", other.folder)
    drakearm("evaluate", tiny, "--out", other.folder, "--policy", run.path("policy"))
    metrics = other.read_json("perturbed", "evaluate")
    assert metrics["perturbations"] == [] and metrics["policy"] == fingerprint(run.path("policy"))
    assert metrics["provenance"]["made_from"]["policy.safetensors"] == ""


def test_a_policy_for_another_task_is_refused(run, tiny, tmp_path):
    policy = Policy.load(run.path("policy"))
    policy.high[:] = 2.0
    policy.save(tmp_path / "strong.safetensors")
    before = contents(run)
    assert "expected excitations, which are from 0 to 1" in drakearm(
        "evaluate", tiny, "--out", run.folder, "--policy", tmp_path / "strong.safetensors", "--overwrite", code=1
    )
    assert contents(run) == before
