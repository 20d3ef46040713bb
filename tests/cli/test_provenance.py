"""A run folder cannot lie: what does not belong together is refused or removed. One command at a time works there."""

import json
import shutil
import signal

import pytest

from tests.cli.command import RUN_FILES, contents, drakearm, start


def names(run):
    return {file.name for file in run.folder.iterdir()}


def test_every_step_records_what_its_files_were_made_from(run):
    for name in ("plan", "training", "metrics"):
        record = json.loads(run.path(name).read_text())["provenance"]
        assert {"scenario.yaml", "arm"} <= set(record["made_from"])
    assert "policy.safetensors" in record["made_from"]
    assert "recording.npz" in run.path("replay").read_text()[-1000:]


def test_a_new_plan_removes_what_was_made_from_the_old_one(run, tiny):
    printed = drakearm("plan", tiny, "--out", run.folder, "--overwrite")
    assert "removed what was made from the earlier files: policy.safetensors" in printed
    assert names(run) == {"scenario.yaml", "reference.npz", "plan.json", "plan.png"}


def test_a_new_evaluation_removes_the_old_replay(run, tiny):
    assert "replay.html" in drakearm("evaluate", tiny, "--out", run.folder, "--overwrite")
    assert not run.path("replay").exists() and run.path("metrics").exists()


def test_a_training_killed_before_its_first_batch_leaves_the_old_one(run, tiny):
    """It used to leave the old policy beside the new training.json."""
    before = contents(run)
    process = start("train", tiny, "--out", run.folder, "--overwrite", "--seed", 7)
    for line in process.stdout:
        if "round 1" in line:
            process.send_signal(signal.SIGKILL)
            break
    process.communicate()
    with run.locked():
        assert contents(run) == before
    drakearm("evaluate", tiny, "--out", run.folder, "--overwrite")
    assert run.read_json("metrics", "evaluate")["seed"] == 3


@pytest.mark.parametrize(
    ("changed", "command", "message"),
    [
        ("scenario", "train", "reference.npz was made from another scenario.yaml"),
        ("reference", "train", r"reference.npz is not the file that `drakearm plan` wrote"),
        ("policy", "evaluate", r"policy.safetensors is not the file that `drakearm train` wrote"),
        ("training", "evaluate", r"training.json is not the file that `drakearm train` wrote"),
        ("recording", "replay", r"recording.npz is not the file that `drakearm evaluate` wrote"),
    ],
)
def test_a_changed_file_is_refused(run, tiny, changed, command, message):
    if changed == "training":
        run.path(changed).write_text(run.path(changed).read_text().replace('"seed": 3', '"seed": 4'))
    else:
        run.path(changed).write_bytes(run.path(changed).read_bytes() + b"\n")
    before = contents(run)
    assert message in drakearm(command, tiny, "--out", run.folder, "--overwrite", code=1)
    assert contents(run) == before


def test_files_of_another_run_are_refused(run, tiny, tmp_path):
    """All files of a training, taken from a run with another reference."""
    other = tmp_path / "other"
    drakearm("plan", tiny, "--out", other, "--horizon", 0.7)
    for name in ("policy", "training", "training_log"):
        shutil.copy(run.path(name), other)
    said = drakearm("evaluate", tiny, "--out", other, code=1)
    assert "policy.safetensors was made from another reference.npz: `drakearm train --overwrite`" in said


def test_a_missing_record_is_named(run, tiny):
    run.path("training").unlink()
    assert "training.json, which belongs to policy" in drakearm(
        "evaluate", tiny, "--out", run.folder, "--overwrite", code=1
    )


def test_two_commands_in_one_folder_exclude_each_other(run, tiny):
    before = contents(run)
    with run.locked():
        other = start("evaluate", tiny, "--out", run.folder, "--overwrite")
        _, errors = other.communicate()
    assert other.returncode == 1 and "Another drakearm command is at work in" in errors
    assert "Traceback" not in errors and contents(run) == before


def test_what_a_killed_command_left_is_cleaned_up(run, tiny):
    for name in (".staged", ".unfinished"):
        (run.folder / name).mkdir()
        (run.folder / name / "policy.safetensors").write_bytes(b"half of a policy")
    drakearm("replay", tiny, "--out", run.folder, "--overwrite")
    assert names(run) == RUN_FILES
