"""Loading an arm: the shipped arm is that of the paper, and messages name what is wrong in a user's folder."""

import copy
import random
import shutil
from pathlib import Path

import pytest
import yaml

from drakearm.errors import LONGEST_MESSAGE, ArmError
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


def refusal(path):
    """The message with which a folder is refused: one sentence that names the file."""
    with pytest.raises(ArmError) as error:
        load_arm(path)
    return one_sentence(path, error.value)


def one_sentence(path, error):
    message = str(error)
    assert message.startswith(str(path / "muscles.yaml")) and message.endswith(".")
    assert len(message) <= LONGEST_MESSAGE and "\n" not in message
    return message


@pytest.mark.parametrize(
    ("section", "value", "expected"),
    [
        ("muscles", "TRIlong", "muscles: found 'TRIlong', expected"),
        ("muscles", [1, 2], "muscles.0: found 1, expected"),
        ("muscles", [], "muscles: found [], expected"),
        ("muscles", None, "muscles: found None, expected"),
        ("name", "a\x07b", "name: found 'a\\x07b', expected a name"),
        ("name", "n" * 101, "name: found"),
        ("name", "", "name: found '', expected"),
        ("skeleton", None, "skeleton: found None, expected the name of a file"),
        ("skeleton", "", "skeleton: found '', expected the name of a file"),
        ("skeleton", ".", "skeleton: there is no file '.'"),
        ("skeleton", "a\x00b", "skeleton: there is no file 'a\\x00b'"),
        ("skeleton", "s" * 5000, "skeleton: there is no file"),
        ("skeleton", "../skeleton.urdf", "skeleton: found '../skeleton.urdf', expected a file in the folder"),
        ("skeleton", "/etc/passwd", "skeleton: found '/etc/passwd', expected a file in the folder"),
        ("coordinates", ["shoulder", "elbow", "elbow"], "elbow is given twice"),
        ("coordinates", "elbow", "coordinates: found 'elbow', expected"),
        ("gravity", [0, True, 0], "gravity.1: found True, expected a number"),
        ("gravity", [0, "9.81", 0], "gravity.1: found '9.81', expected a number"),
        ("outline", [{"name": "hand", "radius": -1, "ends": []}], "outline.hand.radius: found -1, expected a number"),
        ("defaults", [1], "defaults: found [1], expected"),
        ("colour", "red", "colour: there is no such field"),
    ],
)
def test_wrong_section_is_refused_in_one_sentence(folder, section, value, expected):
    assert expected in refusal(folder(lambda fields: fields.update({section: value})))


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("max_isometric_force", 1e9, "BIClong.max_isometric_force: found 1000000000.0, expected 1e-06 to 1e+06 N"),
        ("tendon_slack_length", 1e-4, "BIClong: found a tendon that stretches by 3.3e-06 m"),
        ("tendon_strain", 1e-9, "BIClong.tendon_strain: found 1e-09, expected 0.001 to 1"),
        ("passive_shape", 800, "BIClong.passive_shape: found 800, expected 0.1 to 20"),
        (
            "points",
            [["hand", [1, 2]]],
            "BIClong.points.0: found ['hand', [1, 2]], expected a body and a position in it",
        ),
    ],
)
def test_impossible_muscle_is_refused_with_its_name_and_the_reason(folder, name, value, expected):
    assert expected in refusal(folder(lambda fields: fields["muscles"][3].update({name: value})))


def test_a_wrong_default_is_one_problem(folder):
    def change(fields):
        fields["defaults"] |= {"activation_time": -1, "tendon_strain": "stiff", "colour": "red"}
        fields["muscles"][0]["activation_time"] = 0.01  # does not use the wrong default
        fields["muscles"][5]["optimal_fiber_length"] = 0

    with pytest.raises(ArmError) as error:
        load_arm(folder(change))
    assert "defaults.tendon_strain: found 'stiff', expected a number (and 3 more problems)" in str(error.value)
    notes = sorted(error.value.__notes__)
    assert notes[0].startswith("defaults.activation_time: found -1, expected a number greater than 0")
    assert notes[1] == "defaults.colour: there is no such field."
    assert len(notes) == 3 and notes[2].startswith("muscles.BRA.optimal_fiber_length: found 0")


def test_of_many_problems_ten_are_listed_below_the_first(folder):
    """Each in one line that cannot change the terminal."""

    def change(fields):
        for muscle in fields["muscles"]:
            muscle["max_isometric_force"] = "\x1b[2J"

    with pytest.raises(ArmError, match=r"\(and 13 more problems\)") as error:
        load_arm(folder(change))
    *notes, last = error.value.__notes__
    assert len(notes) == 10 and last == "and 3 more."
    assert all(note.isprintable() and note.endswith(".") for note in notes)


def test_a_misspelled_default_is_named_with_the_field_that_was_meant(folder):
    def change(fields):
        fields["defaults"]["activation_tme"] = fields["defaults"].pop("activation_time")

    assert "defaults.activation_tme: there is no such field (did you mean activation_time?)" in refusal(folder(change))


@pytest.mark.parametrize("name", ["", "a\x00b", "a" * 5000, "x/y/z", "[/red]"])
def test_name_of_an_arm_may_be_anything(name):
    with pytest.raises(ArmError, match=r"There is no arm .* expected one of arm14"):
        load_arm(name)


VALUES = (
    None,
    True,
    "",
    "x",
    "1e3",
    float("nan"),
    float("inf"),
    -1,
    0,
    1e-300,
    1e9,
    1e300,
    2**70,
    [],
    {},
    [[]],
    "\x1b",
)


def mutate(rng, fields):
    """Replaces, removes or repeats a value anywhere in the fields."""
    at, key = fields, rng.choice(list(fields))
    while isinstance(at[key], dict | list) and at[key] and rng.random() < 0.8:
        at = at[key]
        key = rng.choice(list(at)) if isinstance(at, dict) else rng.randrange(len(at))
    chance = rng.random()
    if chance < 0.15:
        del at[key]
    elif chance < 0.3 and isinstance(at, list):
        at.insert(key, at[key])
    elif chance < 0.6 and isinstance(at[key], int | float):
        at[key] *= 10.0 ** rng.uniform(-12.0, 12.0)
    else:
        at[key] = copy.deepcopy(rng.choice(VALUES))


def test_any_damaged_file_is_accepted_or_refused_in_one_sentence(folder):
    rng, refused, path = random.Random(0), 0, folder(lambda fields: None)
    whole = yaml.safe_load((path / "muscles.yaml").read_text())
    whole["muscles"] = whole["muscles"][3:5]
    for muscle in whole["muscles"]:
        muscle["path"] = [{"coordinate": "elbow", "knots": [0, 0, 2, 2], "coefficients": [0.3, 0.4]}]
    for _ in range(150):
        fields = copy.deepcopy(whole)
        mutate(rng, fields)
        text = yaml.safe_dump(fields, allow_unicode=True)
        if rng.random() < 0.2:
            at = rng.randrange(len(text))
            text = (
                text[:at]
                + rng.choice(["", "\x00", ":", "[", "&a", "*a", "\t", "!!python/name:os.system"])
                + text[at + 1 :]
            )
        (path / "muscles.yaml").write_text(text)
        try:
            load_arm(path)
        except ArmError as error:
            refused += 1
            one_sentence(path, error)
    assert 75 < refused < 150
