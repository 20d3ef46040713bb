"""`drakearm train`: its options for TensorBoard and for the device."""

from tests.cli.command import drakearm


def test_progress_for_tensorboard(tiny, tmp_path):
    drakearm("plan", tiny, "--out", tmp_path / "run")
    drakearm("train", tiny, "--out", tmp_path / "run", "--tensorboard", tmp_path / "log", "--device", "cpu")
    assert [file.name for file in (tmp_path / "log").iterdir() if "tfevents" in file.name]


def test_an_unknown_device_is_refused_and_nothing_is_written(tiny, tmp_path):
    drakearm("plan", tiny, "--out", tmp_path / "run")
    printed = drakearm("train", tiny, "--out", tmp_path / "run", "--device", "abacus", code=1)
    assert "no device 'abacus'" in " ".join(printed.split())
    assert not (tmp_path / "run" / "policy.safetensors").exists()
