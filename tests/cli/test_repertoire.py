"""`drakearm move`, `learn` and `plan-library` from the command line."""

import pytest

from tests.cli.command import drakearm
from tests.repertoire.conftest import small  # noqa: F401


def test_move_writes_plan_pictures_and_replay(tmp_path):
    printed = drakearm("move", "--to", "0.35", "0.5", "--from", "-10", "70", "--out", tmp_path)
    assert "replay.html" in printed and "cm" in printed
    assert (tmp_path / "replay.html").stat().st_size > 1_000_000 and (tmp_path / "movement.png").exists()


def test_move_refuses_with_one_sentence(tmp_path):
    sentence = drakearm("move", "--to", "2", "0.5", "--out", tmp_path / "none", code=1)
    assert sentence.startswith("The hand cannot reach x = 2 m")
    assert not (tmp_path / "none").exists()


@pytest.mark.slow
@pytest.mark.extra
def test_a_repertoire_is_planned_and_learned(small, tmp_path):  # noqa: F811
    file = tmp_path / "learned" / "library.npz"
    assert "2 movements" in drakearm("plan-library", small, "--out", file)
    assert "is there already" in drakearm("plan-library", small, "--out", file)
    printed = drakearm("learn", small, "--out", file.parent)
    assert "within 1 cm" in printed and (file.parent / "policy.safetensors").exists()
