"""Full disks, read-only folders and impossible places: one sentence, exit code 1, and what was there stays."""

import ctypes
import errno
import os

import pytest

from tests.cli.command import contents, drakearm, start
from tests.full_disk import full_disk

STEPS = ["plan", "train", "evaluate", "replay"]
WRITTEN = {  # by each step, the file after which the disk is full
    "plan": ["scenario.yaml", "reference.npz", "plan.json", "plan.png"],
    "train": ["policy.safetensors", "training.csv"],
    "evaluate": ["recording.npz", "movement.png", "metrics.json"],
    "replay": ["replay.html"],
}


@pytest.mark.parametrize(("step", "file"), [(step, file) for step in STEPS for file in WRITTEN[step]])
def test_a_full_disk_leaves_the_earlier_results(run, tiny, step, file):
    before = contents(run)
    with full_disk(room=int(0.9 * len(before[file]))):
        said = drakearm(step, tiny, "--out", run.folder, "--overwrite", code=1)
    assert said.endswith(f"cannot be written: {os.strerror(errno.EFBIG)}.") and len(said) <= 300
    assert contents(run) == before
    drakearm(step, tiny, "--out", run.folder, "--overwrite")


def _obey_permissions():
    """A process of root may write everywhere. Without this capability it may not."""
    PR_CAPBSET_DROP, CAP_DAC_OVERRIDE = 24, 1
    ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0)


@pytest.mark.slow
@pytest.mark.extra
@pytest.mark.parametrize("step", STEPS)
def test_a_read_only_folder_is_one_sentence(run, tiny, step):
    before = contents(run)
    run.folder.chmod(0o555)
    try:
        process = start(step, tiny, "--out", run.folder, "--overwrite", preexec_fn=_obey_permissions)
        _, errors = process.communicate()
    finally:
        run.folder.chmod(0o755)
    assert process.returncode == 1 and contents(run) == before
    (line,) = errors.strip().splitlines()
    assert line.startswith("error: ") and os.strerror(errno.EACCES) in line


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("file", "is a file: expected a folder"),
        ("file/below", os.strerror(errno.ENOTDIR)),
        ("x" * 300, os.strerror(errno.ENAMETOOLONG)),
        ("/proc/nowhere", "cannot be made"),
    ],
)
@pytest.mark.parametrize("command", ["plan", "run"])
def test_an_impossible_folder_is_one_sentence(tiny, tmp_path, place, message, command):
    (tmp_path / "file").write_text("kept")
    said = drakearm(command, tiny, "--out", tmp_path / place, code=1)
    assert message in said and len(said) <= 300 and "\n" not in said
    assert (tmp_path / "file").read_text() == "kept"
