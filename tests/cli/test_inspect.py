"""`drakearm inspect`: its table, its picture and what it refuses."""

import shutil

import yaml
from matplotlib.image import imread

from tests.cli.command import drakearm
from tests.limbs import write_fork


def inspect(*arguments, code=0):
    """What `drakearm inspect` prints, or the sentence of its error."""
    return drakearm("inspect", *arguments, code=code)


def test_writes_the_picture_and_prints_every_muscle(arm, tmp_path):
    file = tmp_path / "new" / "arm.png"
    text = inspect("arm14", "--out", file)
    for name in arm.muscle_names:
        assert name in text
    assert "thelen2003" in text and "compliant" in text and "arm.png" in text.replace("\n", "")
    height, width, _ = imread(file).shape
    assert height > width > 1000


def test_an_arm_of_ones_own_and_its_picture_is_replaced_only_on_demand(arm, tmp_path, monkeypatch):
    fields = yaml.safe_load((arm.skeleton.parent / "muscles.yaml").read_text())
    brachialis = next(m for m in fields["muscles"] if m["name"] == "BRA")
    (tmp_path / "muscles.yaml").write_text(yaml.safe_dump({**fields, "name": "mine", "muscles": [brachialis]}))
    shutil.copy(arm.skeleton, tmp_path)
    monkeypatch.chdir(tmp_path)
    picture = tmp_path / "mine.png"
    picture.write_text("an earlier picture")
    assert "exists already" in inspect(tmp_path, code=1)
    assert picture.read_text() == "an earlier picture"
    assert "BRA" in inspect(tmp_path, "--overwrite")
    assert imread(picture).ndim == 3


def test_a_picture_is_a_png(tmp_path):
    assert "ends in .png" in inspect("arm14", "--out", tmp_path / "arm.jpg", code=1)


def test_unknown_arm_lists_the_known_ones():
    assert "expected one of arm14" in inspect("leg", code=1)


def test_a_close_name_of_an_arm_is_suggested():
    assert "did you mean arm14?" in inspect("arm-14", code=1)


def test_a_tree_with_a_muscle_over_two_joints_together(tmp_path):
    picture = tmp_path / "fork.png"
    assert "long" in inspect(write_fork(tmp_path / "fork"), "--out", picture)
    assert imread(picture).ndim == 3
