"""The command `drakearm inspect`: its table, its picture and its refusals."""

import shutil
from dataclasses import replace
from io import StringIO

import pytest
import yaml
from matplotlib.image import imread
from rich.console import Console
from typer.testing import CliRunner

from drakearm import cli
from drakearm.errors import ArmError, RunFolderError
from drakearm.experiments.arm_picture import draw_arm
from drakearm.experiments.arm_table import muscle_table
from drakearm.model.inspection import inspect_arm


def inspect(*arguments):
    """Runs the command in this process and returns what it printed."""
    result = CliRunner().invoke(cli.app, ["inspect", *(str(a) for a in arguments)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def printed(table, width=120):
    console = Console(width=width, file=StringIO())
    console.print(table)
    return console.file.getvalue()


@pytest.fixture(scope="module")
def small(arm):
    """Muscles of every kind: partly slack, slack everywhere, rigid, of the other model."""
    muscles = {m.name: m for m in arm.muscles}
    biceps, wrist = muscles["BIClong"], muscles["FCU"]
    return replace(
        arm,
        muscles=(
            replace(biceps, tendon_slack_length=1.25 * biceps.tendon_slack_length),
            replace(wrist, tendon_slack_length=1.5 * wrist.tendon_slack_length),
            replace(muscles["BRA"], tendon="rigid"),
            replace(muscles["ANC"], model="degroote2016"),
        ),
    )


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
    with pytest.raises(RunFolderError, match="exists already"):
        inspect(tmp_path)
    assert picture.read_text() == "an earlier picture"
    assert "BRA" in inspect(tmp_path, "--overwrite")
    assert imread(picture).ndim == 3


def test_a_picture_is_a_png(tmp_path):
    with pytest.raises(RunFolderError, match=r"ends in \.png"):
        inspect("arm14", "--out", tmp_path / "arm.jpg")


def test_unknown_arm_lists_the_known_ones():
    with pytest.raises(ArmError, match="expected one of arm14"):
        inspect("leg")


def test_table_holds_the_numbers_of_the_file(arm):
    row = next(line for line in printed(muscle_table(inspect_arm(arm))).splitlines() if line.startswith("FCU"))
    for number in ("479.8", "50.9", "265", "12.0", "104", "elbow 3…14", "0.48…0.90"):
        assert number in row


def test_table_fits_a_terminal_of_80_columns(arm):
    text = printed(muscle_table(inspect_arm(arm)), width=80)
    assert max(len(line) for line in text.splitlines()) <= 80
    for part in (*arm.muscle_names, "-38…-6", "0.80…1.78"):
        assert part in text


def test_table_says_where_muscles_have_no_equilibrium(small):
    text = " ".join(printed(muscle_table(inspect_arm(small))).split())
    assert "BIClong has no equilibrium where its path is shorter than 34" in text
    assert "FCU has no equilibrium: its tendon is slack everywhere" in text


def test_picture_has_a_row_a_muscle_of_any_kind(small):
    figure = draw_arm(inspect_arm(small))
    texts = [text.get_text() for panel in figure.axes for text in panel.texts]
    assert len(figure.axes) == 5 * len(small.muscles)
    for text in (*small.muscle_names, "rigid tendon"):
        assert text in texts
    figure.canvas.draw()
