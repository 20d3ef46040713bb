"""`drakearm run` and the steps one by one, on a tiny budget, and what they refuse."""

import csv
import json
import os
import pty
import re
import shutil
from contextlib import suppress

import numpy as np
import pytest
import yaml

from drakearm.learning import Policy
from drakearm.model import load_arm
from drakearm.model.recording import Recording, load_recordings
from drakearm.model.reference import Reference
from tests.cli.command import RUN_FILES, drakearm, start


def numbers(out):
    """metrics.json without what depends on the clock."""
    metrics = json.loads((out / "metrics.json").read_text())
    return {key: value for key, value in metrics.items() if not key.endswith("_seconds")}


def test_run_writes_every_file_and_prints_a_table(finished):
    out, printed = finished
    assert {file.name for file in out.iterdir()} == RUN_FILES
    for part in ("Gauss-Newton", "solution found", "600 steps", "mean error", "shoulder", "elbow", "seed 3", "replay"):
        assert part in printed, part


def test_without_a_terminal_progress_is_lines_of_text(finished):
    lines = [line for line in finished[1].splitlines() if line.startswith("training")]
    rounds = [f"training: imitated static optimization, round {number} of 4" for number in range(1, 5)]
    assert lines[:4] == rounds
    assert len(lines) == 5 and lines[4].startswith("training 2 of 2: error 0.")


def test_a_line_is_printed_every_ten_batches_and_at_the_end(tiny, tmp_path):
    drakearm("plan", tiny, "--out", tmp_path)
    printed = drakearm("train", tiny, "--batches", 25, "--out", tmp_path)
    assert re.findall(r"^training (\d+) of 25: error", printed, re.MULTILINE) == ["10", "20", "25"]


def test_in_a_terminal_progress_is_a_bar(tiny, tmp_path):
    drakearm("plan", tiny, "--out", tmp_path)
    terminal, end = pty.openpty()
    process = start("train", tiny, "--out", tmp_path, stdout=end, env={**os.environ, "TERM": "xterm"})
    os.close(end)
    printed = b""
    with suppress(OSError):  # the process has closed its end
        while part := os.read(terminal, 1024):
            printed += part
    os.close(terminal)
    assert process.wait() == 0
    assert "━" in printed.decode() and "2/2" in printed.decode()
    assert "training 2 of 2" not in printed.decode()


def test_run_continues_with_the_plan_in_the_folder(finished, tiny, tmp_path):
    drakearm("plan", tiny, "--out", tmp_path)
    before = (tmp_path / "plan.json").read_bytes()
    printed = drakearm("run", tiny, "--out", tmp_path, "--seed", 3)
    assert "continuing with the plan in" in printed and "planned with" not in printed
    assert (tmp_path / "plan.json").read_bytes() == before
    assert numbers(tmp_path) == numbers(finished[0])


def test_run_refuses_a_plan_of_another_preset(tiny, tmp_path):
    drakearm("plan", tiny, "--out", tmp_path)
    before = (tmp_path / "plan.json").read_bytes()
    assert "exists already" in drakearm("run", tiny, "--out", tmp_path, "--preset", "paper", code=1)
    assert (tmp_path / "plan.json").read_bytes() == before


def test_metrics_hold_what_is_promised(finished):
    metrics = json.loads((finished[0] / "metrics.json").read_text())
    assert metrics["joints"] == ["shoulder", "elbow"]
    for key in ("tracking_error_mean", "tracking_error_max", "end_error"):
        assert np.shape(metrics["noise_free"][key]) == (2,) and np.shape(metrics["noisy"][key]) == (10, 2)
    for key in ("hand_end_error_cm", "hand_end_speed", "squared_activation", "metabolic_energy"):
        assert metrics["noise_free"][key] > 0.0 and np.shape(metrics["noisy"][key]) == (10,)
    for name, share in metrics["success_rate"].items():
        assert share == np.mean([success[name] for success in metrics["noisy"]["success"]])
    assert set(metrics["success_rate"]) == {"end_error", "mean_error"}
    assert metrics["training_steps"] == 600
    assert metrics["training_seconds"] > 0.0 and metrics["plan_seconds"] > 0.0
    assert metrics["seed"] == 3
    assert {"python", "drakearm", "drake", "torch", "numpy", "numba", "gymnasium"} == set(metrics["versions"])


def test_metrics_are_those_of_the_recording(finished):
    out, _ = finished
    recording, metrics = Recording.load(out / "recording.npz"), json.loads((out / "metrics.json").read_text())
    error = np.abs(recording.q - Reference.load(out / "reference.npz").q)
    np.testing.assert_allclose(metrics["noise_free"]["tracking_error_mean"], error.mean(axis=0))
    np.testing.assert_allclose(metrics["noise_free"]["tracking_error_max"], error.max(axis=0))
    np.testing.assert_allclose(metrics["noise_free"]["end_error"], error[-1])
    for end_error, noisy in zip(metrics["noisy"]["end_error"], load_recordings(out / "noisy.npz"), strict=True):
        np.testing.assert_allclose(end_error, np.abs(noisy.q - recording.reference_q)[-1])


def test_log_has_one_row_per_batch_with_the_diagnostics(finished):
    rows = list(csv.DictReader((finished[0] / "training.csv").open()))
    assert [row["batch"] for row in rows] == ["1", "2"]
    for key in ("approx_kl", "clip_fraction", "explained_variance", "tracking_error", "steps_per_second"):
        assert np.isfinite(float(rows[-1][key]))


def test_policy_file_says_where_it_comes_from(finished):
    metadata = Policy.load(finished[0] / "policy.safetensors").metadata
    assert (metadata["scenario"], metadata["seed"]) == ("tiny", 3)


def test_same_seed_same_numbers_and_the_steps_one_by_one_do_the_same(finished, tiny, tmp_path):
    for step in (["plan"], ["train", "--seed", 3], ["evaluate"], ["replay"]):
        drakearm(step[0], tiny, *step[1:], "--out", tmp_path)
    assert numbers(tmp_path) == numbers(finished[0])


@pytest.mark.slow
def test_training_on_diagrams_learns_the_same(finished, tiny, tmp_path):
    """Rounding differs between the two kinds of environment, so numbers agree to what one learns in two batches."""
    drakearm("run", tiny, "--out", tmp_path, "--seed", 3, "--env", "diagram")
    np.testing.assert_allclose(
        numbers(tmp_path)["noise_free"]["tracking_error_mean"],
        numbers(finished[0])["noise_free"]["tracking_error_mean"],
        atol=1e-3,
    )


def test_limb_of_a_users_own(tiny, tmp_path):
    """A folder with another limb beside the scenario file: it is used, and kept with the run."""
    limb = tmp_path / "lab" / "limb"
    shutil.copytree(load_arm("arm14").skeleton.parent, limb)
    muscles = yaml.safe_load((limb / "muscles.yaml").read_text())
    muscles["muscles"] = muscles["muscles"][:9]
    (limb / "muscles.yaml").write_text(yaml.safe_dump({**muscles, "name": "limb"}))
    fields = yaml.safe_load(open(tiny).read())
    scenario = tmp_path / "lab" / "mine.yaml"
    scenario.write_text(yaml.safe_dump({**fields, "name": "mine", "arm": "limb"}))
    drakearm("run", scenario, "--out", tmp_path / "run")
    shutil.rmtree(tmp_path / "lab")
    drakearm("evaluate", tmp_path / "run" / "scenario.yaml", "--out", tmp_path / "run", "--overwrite")
    assert Recording.load(tmp_path / "run" / "recording.npz").activation.shape == (76, 9)


def test_nothing_is_overwritten_silently(finished, tiny):
    out, _ = finished
    before = numbers(out)
    for step in ("run", "plan", "train", "evaluate", "replay"):
        assert "exists already" in drakearm(step, tiny, "--out", out, code=1)
    assert numbers(out) == before


def test_overwrite_replaces(finished, tiny, tmp_path):
    out = shutil.copytree(finished[0], tmp_path / "run")
    before = numbers(out)
    drakearm("evaluate", tiny, "--out", out, "--overwrite")
    assert numbers(out) == before


def test_missing_step_is_named(tiny, tmp_path):
    assert "drakearm plan" in drakearm("train", tiny, "--out", tmp_path, code=1)
    drakearm("plan", tiny, "--out", tmp_path)
    assert "drakearm train" in drakearm("evaluate", tiny, "--out", tmp_path, code=1)
    assert "drakearm train" in drakearm("replay", tiny, "--out", tmp_path, code=1)


def test_folder_of_another_scenario_is_refused(finished):
    out, _ = finished
    for step in ("train", "evaluate", "replay"):
        assert "holds a run of tiny" in drakearm(step, "timing-0.7s", "--out", out, "--overwrite", code=1)
