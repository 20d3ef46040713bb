"""The commands with a shipped policy: nothing has to be planned or trained first."""

import json

from tests.cli.command import drakearm


def test_evaluate_measures_the_shipped_policy_of_a_new_run(tmp_path):
    out = tmp_path / "run"
    printed = drakearm("evaluate", "timing-0.4s", "--out", out)
    assert "using the policy that drakearm ships" in printed
    metrics = json.loads((out / "metrics.json").read_text())
    assert max(metrics["noise_free"]["tracking_error_mean"]) < 0.01
    assert "exists already" in drakearm("evaluate", "timing-0.4s", "--out", out, code=1)  # as for any other run
    assert "open" in drakearm("replay", "timing-0.4s", "--out", out)
    assert "replay.html" in drakearm("replay", out, "--overwrite")  # the folder of the run


def test_replay_evaluates_first_where_there_is_no_recording(tmp_path):
    out = tmp_path / "run"
    drakearm("replay", "timing-0.4s", "--out", out)
    assert (out / "replay.html").exists() and (out / "metrics.json").exists()


def test_a_run_with_only_the_plan_of_the_scenario_keeps_it_and_gets_the_shipped_policy(tmp_path):
    out = tmp_path / "run"
    drakearm("plan", "timing-0.4s", "--out", out)
    planned = (out / "plan.json").read_bytes()
    assert "using the policy that drakearm ships" in drakearm("evaluate", "timing-0.4s", "--out", out)
    assert (out / "plan.json").read_bytes() == planned


def test_a_run_with_another_plan_asks_for_a_training(tmp_path):
    out = tmp_path / "run"
    drakearm("plan", "timing-0.4s", "--out", out, "--horizon", 1.6)
    assert "`drakearm train timing-0.4s` makes it" in drakearm("evaluate", "timing-0.4s", "--out", out, code=1)


def test_export_makes_what_it_needs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    printed = drakearm("export", "timing-0.4s", "--csv")
    assert "using the policy that drakearm ships" in printed and "wrote timing-0.4s.csv" in printed
    assert drakearm("export", "timing-0.4s", "--sto") == "wrote timing-0.4s.sto\n"


def test_static_optimization_needs_no_training(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "not trained" in drakearm("evaluate", "timing-0.4s", "--policy", "static", "--out", "static")
    assert drakearm("export", "static", "--csv") == "wrote timing-0.4s.csv\n"
    drakearm("evaluate", "timing-0.4s", "--policy", "static", "--load", 1, code=2)
    drakearm("evaluate", "timing-0.4s")
    assert "has a policy" in drakearm("evaluate", "timing-0.4s", "--policy", "static", "--overwrite", code=1)
