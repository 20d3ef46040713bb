"""`drakearm export`: which run it takes, which file it writes, and what it refuses."""

import shutil

import numpy as np
import pytest

from drakearm.model.recording import Recording
from tests.cli.command import contents, drakearm


@pytest.mark.parametrize("suffix", ["csv", "sto", "mot"])
def test_a_run_folder_becomes_a_file_in_the_current_folder(run, tmp_path, monkeypatch, suffix):
    monkeypatch.chdir(tmp_path)
    before = contents(run)
    assert drakearm("export", run.folder, f"--{suffix}") == f"wrote tiny.{suffix}\n"
    rows = (tmp_path / f"tiny.{suffix}").read_text().splitlines()[-76:]
    t = [float(row.replace(",", "\t").split("\t")[0]) for row in rows]
    np.testing.assert_allclose(t, Recording.load(run.path("recording")).t)
    assert contents(run) == before


def test_a_scenario_stands_for_its_run_in_runs(finished, tiny, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(finished[0], tmp_path / "runs" / "tiny")
    drakearm("export", tiny, "--csv", "--out", "tables/mine.csv")
    assert (tmp_path / "tables" / "mine.csv").is_file()


@pytest.mark.parametrize(
    ("arguments", "code", "sentence"),
    [
        (["--csv", "--out", "kept.csv"], 1, "kept.csv exists already: choose another file with --out"),
        (["--csv", "--out", "x.sto"], 1, "is no name for a table: expected one that ends in .csv"),
        (["--mot", "--coordinates", "elbow/elbow_flexion"], 1, "There are 1 coordinates for OpenSim"),
        ([], 2, "expected one of --csv, --sto and --mot"),
        (["--csv", "--mot"], 2, "expected one of --csv, --sto and --mot"),
    ],
)
def test_what_is_not_clear_is_refused(run, tmp_path, monkeypatch, arguments, code, sentence):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "kept.csv").write_text("an earlier table")
    assert sentence in " ".join(drakearm("export", run.folder, *arguments, code=code).split())
    assert (tmp_path / "kept.csv").read_text() == "an earlier table"


def test_an_earlier_file_is_replaced_on_demand(run, tmp_path):
    file = tmp_path / "x.csv"
    file.write_text("an earlier table")
    drakearm("export", run.folder, "--csv", "--out", file, "--overwrite")
    assert file.read_text().startswith("time_s,")


def test_a_run_that_is_not_evaluated_is_refused(run, tmp_path):
    run.path("recording").unlink()
    assert "recording.npz is missing: `drakearm evaluate" in drakearm("export", run.folder, "--csv", code=1)
    assert "scenario.yaml is missing" in drakearm("export", tmp_path, "--csv", code=1)
    assert "There is no scenario 'dancing'" in drakearm("export", "dancing", "--csv", code=1)
