"""Loading an arm: the shipped arm is that of the paper, and messages name what is wrong in a user's folder."""

import shutil
from pathlib import Path

import pytest
import yaml

from drakearm.errors import ArmError
from drakearm.model import load_arm

SHIPPED = Path(load_arm("arm14").skeleton).parent


@pytest.fixture
def folder(tmp_path):
    """A user's own folder: a copy of the shipped arm, with a function that edits its muscle file."""
    for name in ("muscles.yaml", "skeleton.urdf"):
        shutil.copy(SHIPPED / name, tmp_path)

    def edit(change):
        file = tmp_path / "muscles.yaml"
        fields = yaml.safe_load(file.read_text())
        change(fields)
        file.write_text(yaml.safe_dump(fields))
        return tmp_path

    return edit


def test_shipped_arm_is_that_of_the_paper():
    arm = load_arm("arm14")
    assert arm.muscle_names == (
        *("TRIlong", "TRIlat", "TRImed", "BIClong", "BICshort", "BRA", "ANC"),
        *("BRD", "ECRL", "ECRB", "ECU", "FCR", "FCU", "PL"),
    )
    assert arm.coordinates == ("shoulder", "elbow")
    across_shoulder = [m.name for m in arm.muscles if any(t.coordinate == "shoulder" for t in m.path)]
    assert across_shoulder == ["TRIlong", "BIClong", "BICshort"]
    assert arm.muscles[0].max_isometric_force == 798.52
    assert arm.muscles[0].minimum_fiber_length == pytest.approx(0.0280005209, abs=1e-10)


def test_folder_of_a_user_loads_like_the_shipped_one(folder):
    own = load_arm(folder(lambda fields: None))
    assert own.muscles == load_arm("arm14").muscles
    assert own.skeleton.parent == folder(lambda fields: None).resolve()


def test_arm_is_frozen(arm):
    with pytest.raises(AttributeError):
        arm.muscles[0].optimal_fiber_length = 1.0


def _no_tendon(fields):
    del fields["muscles"][3]["tendon_slack_length"]


def _unknown(fields):
    fields["muscles"][3]["colour"] = "red"


def _negative(fields):
    fields["muscles"][3]["optimal_fiber_length"] = -0.1


def _not_a_number(fields):
    fields["muscles"][3]["max_isometric_force"] = "strong"


def _twice(fields):
    fields["muscles"][3]["name"] = "BRA"


def _no_coordinate(fields):
    del fields["muscles"][3]["path"][0]["coordinate"]


def _foreign_coordinate(fields):
    fields["muscles"][3]["path"][0]["coordinate"] = "wrist"


def _too_many_coefficients(fields):
    path = fields["muscles"][3]["path"][0]
    path["coefficients"] = path["knots"]


def _no_muscles(fields):
    del fields["muscles"]


def _no_skeleton(fields):
    fields["skeleton"] = "nowhere.urdf"


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (_no_tendon, ["BIClong.tendon_slack_length", "required"]),
        (_unknown, ["BIClong.colour"]),
        (_negative, ["BIClong.optimal_fiber_length", "greater than 0", "-0.1"]),
        (_not_a_number, ["BIClong.max_isometric_force", "number", "strong"]),
        (_twice, ["muscles", "BRA is given twice"]),
        (_no_coordinate, ["BIClong.path.0.coordinate", "required"]),
        (_foreign_coordinate, ["wrist", "shoulder, elbow"]),
        (_too_many_coefficients, ["BIClong.path.0.coefficients", "knots"]),
        (_no_muscles, ["muscles", "required"]),
        (_no_skeleton, ["skeleton", "nowhere.urdf"]),
    ],
)
def test_wrong_file_is_an_error_that_names_file_field_and_expectation(folder, change, named):
    path = folder(change)
    with pytest.raises(ArmError) as error:
        load_arm(path)
    for part in [str(path / "muscles.yaml"), *named]:
        assert part in str(error.value)


def test_unknown_arm_lists_the_known_ones(tmp_path):
    with pytest.raises(ArmError, match="arm14"):
        load_arm(tmp_path / "leg")


@pytest.mark.parametrize("text", ["muscles: [", "- a list", ""])
def test_file_that_does_not_hold_a_mapping_is_an_error(tmp_path, text):
    (tmp_path / "muscles.yaml").write_text(text)
    with pytest.raises(ArmError, match=r"muscles\.yaml"):
        load_arm(tmp_path)
