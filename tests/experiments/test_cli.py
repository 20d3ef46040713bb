"""The command `drakearm`, end to end on a tiny budget, and its refusals."""

import csv
import json
import shutil

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from drakearm import cli
from drakearm.experiments.run_folder import RunFolder
from drakearm.experiments.scenario import scenario_files
from drakearm.experiments.steps import plan_step, train_step
from drakearm.learning import Policy
from drakearm.model import load_arm
from drakearm.model.recording import Recording
from drakearm.model.reference import Reference


@pytest.fixture(scope="session")
def tiny(tmp_path_factory):
    """A scenario like timing-0.7s that plans with few knots and trains on few arms."""
    fields = yaml.safe_load(scenario_files()["timing-0.7s"].read_text())
    fields["movement"]["knots"] = 15
    fields["training"] = {"batches": 2, "environments": 4, "minibatches": 2, "epochs": 2}
    file = tmp_path_factory.mktemp("scenario") / "tiny.yaml"
    file.write_text(yaml.safe_dump({**fields, "name": "tiny"}))
    return str(file)


def drakearm(*arguments, code=0):
    """Runs the command in this process and returns what it printed."""
    try:
        result = CliRunner().invoke(cli.app, [str(a) for a in arguments], catch_exceptions=False)
    except cli.DrakearmError as error:
        assert code == 1
        return str(error)
    assert result.exit_code == code, result.output
    return result.output


@pytest.fixture(scope="session")
def finished(tiny, tmp_path_factory):
    out = tmp_path_factory.mktemp("runs") / "tiny"
    printed = drakearm("run", tiny, "--out", out, "--seed", 3)
    return out, printed


def numbers(out):
    """metrics.json without what depends on the clock."""
    metrics = json.loads((out / "metrics.json").read_text())
    return {key: value for key, value in metrics.items() if not key.endswith("_seconds")}


def test_run_writes_every_file_and_prints_a_table(finished):
    out, printed = finished
    assert {file.name for file in out.iterdir()} == set(RunFolder.FILES.values())
    for part in ("Gauss-Newton", "solution found", "600 steps", "mean error", "shoulder", "elbow", "seed 3", "replay"):
        assert part in printed, part


def test_metrics_hold_what_is_promised(finished):
    metrics = json.loads((finished[0] / "metrics.json").read_text())
    for key in ("tracking_error_mean", "tracking_error_max", "end_error"):
        assert np.shape(metrics[key]) == (2,)
    assert 0.0 <= metrics["success_rate"] <= 1.0
    assert metrics["training_steps"] == 600
    assert metrics["training_seconds"] > 0.0 and metrics["plan_seconds"] > 0.0
    assert metrics["seed"] == 3
    assert {"python", "drakearm", "drake", "torch", "numpy", "numba", "gymnasium"} == set(metrics["versions"])
    assert len(metrics["stochastic_runs"]["end_error"]) == 10


def test_metrics_are_those_of_the_recording(finished):
    out, _ = finished
    recording, metrics = Recording.load(out / "recording.npz"), json.loads((out / "metrics.json").read_text())
    error = np.abs(recording.q - Reference.load(out / "reference.npz").q)
    np.testing.assert_allclose(metrics["tracking_error_mean"], error.mean(axis=0))
    np.testing.assert_allclose(metrics["tracking_error_max"], error.max(axis=0))
    np.testing.assert_allclose(metrics["end_error"], error[-1])


def test_log_has_a_row_a_batch_with_the_diagnostics(finished):
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
        numbers(tmp_path)["tracking_error_mean"], numbers(finished[0])["tracking_error_mean"], atol=1e-3
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


def test_interrupted_training_leaves_a_policy_that_can_be_evaluated(tiny, tmp_path):
    run = RunFolder(tmp_path)
    plan_step(run, tiny)

    def interrupt(report):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train_step(run, seed=0, on_batch=interrupt)
    drakearm("evaluate", tiny, "--out", tmp_path)
    assert numbers(tmp_path)["training_steps"] == 300
    assert not json.loads((tmp_path / "training.json").read_text())["finished"]


def test_nothing_is_overwritten_silently(finished, tiny):
    out, _ = finished
    before = numbers(out)
    for step in ("run", "plan", "train", "evaluate", "replay"):
        assert "exists already" in drakearm(step, tiny, "--out", out, code=1)
    assert numbers(out) == before


def test_overwrite_replaces(finished, tiny):
    out, _ = finished
    before = numbers(out)
    drakearm("evaluate", tiny, "--out", out, "--overwrite")
    assert numbers(out) == before


def test_missing_step_is_named(tiny, tmp_path):
    assert "drakearm plan" in drakearm("train", tiny, "--out", tmp_path, code=1)
    drakearm("plan", tiny, "--out", tmp_path)
    assert "drakearm train" in drakearm("evaluate", tiny, "--out", tmp_path, code=1)
    assert "drakearm evaluate" in drakearm("replay", tiny, "--out", tmp_path, code=1)


def test_folder_of_another_scenario_is_refused(finished):
    out, _ = finished
    for step in ("train", "evaluate", "replay"):
        assert "holds a run of tiny" in drakearm(step, "timing-0.7s", "--out", out, "--overwrite", code=1)


def test_unknown_scenario_lists_the_known_ones():
    assert "timing-0.7s" in drakearm("run", "dancing", code=1)


def test_errors_are_one_sentence_and_exit_code_1(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["drakearm", "run", "dancing"])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == 1
    printed = capsys.readouterr().err
    assert "timing-0.7s" in printed and "Traceback" not in printed


def test_list_shows_the_shipped_scenarios():
    printed = drakearm("list")
    for name in scenario_files():
        assert name in printed


@pytest.mark.parametrize("command", [[], ["plan"], ["train"], ["evaluate"], ["replay"], ["run"], ["list"]])
def test_help_teaches(command):
    printed = CliRunner().invoke(cli.app, [*command, "--help"]).output
    assert len(printed) > 200
    if command and command != ["list"]:
        assert "SCENARIO" in printed and "--out" in printed
