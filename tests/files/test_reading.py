"""Text, YAML and JSON from damaged or hostile files: a mapping, or one sentence; no code, little memory and time."""

import pytest

from drakearm.errors import LONGEST_MESSAGE, ArmError
from drakearm.files import parse_json, read_json, read_yaml


@pytest.fixture
def file(tmp_path):
    return tmp_path / "file"


def refusal(read, file, content: str | bytes) -> str:
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(ArmError) as error:
        read(file, ArmError)
    message = str(error.value)
    assert str(file) in message and len(message) <= LONGEST_MESSAGE and message.isprintable()
    return message


def test_yaml_has_plain_values_only(file):
    file.write_text("a: 2020-01-01\nb: 1e3\nc: 010\nd: 10:30\ne: [true, null, .inf]\nf: {<<: {g: 1}}\n=: 1")
    assert read_yaml(file, ArmError) == {
        "a": "2020-01-01",
        "b": 1000.0,
        "c": 10,
        "d": "10:30",
        "e": [True, None, float("inf")],
        "f": {"<<": {"g": 1}},
        "=": 1,
    }


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"\xff\xfe", "byte 0 is not UTF-8"),
        (b"a: \0", "not valid YAML"),
        ("", "expected fields with values, found None"),
        ("[1]", "expected fields with values"),
        ("a: [", "not valid YAML in line"),
        ("- a: 1\n  b: 2\n c: 3", "line 3: the line is not indented like the lines above it"),
        ("a: 1\n  b: 2", "line 2: this line, or the one above, is not indented like the other ones"),
        ("a: 1\nb 2\nc: 3", "this line, or the one above, has no name with a colon and a space after it"),
        ("a:\n\tb: 2", "found a tab, expected spaces"),
        ("a: [1, 2\nb: 3", "a bracket is not closed, or a comma is missing"),
        ("a: !!python/object/apply:os.getcwd []", "found the tag 'tag:yaml.org"),
        ("a: 1\na: 2", "'a' twice"),
        ("? [1]\n: 2", "expected text"),
        ("1: 2", "expected names that are text"),
        ("a: &x [*x]", "at most 50 lists and mappings inside each other"),
        ("a: " + "[" * 10_000, "at most 50 lists"),
        ("a: " + "1" * 5000, "thousands of digits"),
        ("a: 1\n" + "#" * 600_000, "larger than 500 kB"),
        (
            "x0: &x0 [1, 1]\n" + "".join(f"x{i + 1}: &x{i + 1} [{', '.join([f'*x{i}'] * 9)}]\n" for i in range(9)),
            "more than 100,000 values",
        ),
    ],
)
def test_what_is_wrong_in_yaml_is_said(file, content, sentence):
    assert sentence in refusal(read_yaml, file, content)


def test_many_fields_are_read_quickly(file):
    """A search for a name given twice that compares all pairs would take minutes."""
    file.write_text("".join(f"k{i}: 1\n" for i in range(30_000)))
    assert len(read_yaml(file, ArmError)) == 30_000


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("[]", "expected fields with values, found []"),
        ("{", "not valid JSON"),
        ('{"a": NaN}', "found NaN, expected a finite number"),
        ('{"a": [1e999]}', "found 1e999, expected a finite number"),
        ('{"a": ' + "1" * 5000 + "}", "not valid JSON"),
        ('{"a": ' + "[" * 100_000, "at most 50 lists"),
        ('{"a": ' + "[" * 60 + "]" * 60 + "}", "at most 50 lists"),
        (" " * 6_000_000, "larger than 5000 kB"),
    ],
)
def test_what_is_wrong_in_json_is_said(file, content, sentence):
    assert sentence in refusal(read_json, file, content)


def test_a_missing_file_and_an_impossible_path_are_said(tmp_path):
    for path in (tmp_path / "none", tmp_path, tmp_path / "a\0b", tmp_path / ("x" * 5000)):
        with pytest.raises(ArmError, match="cannot be read"):
            read_yaml(path, ArmError)


def test_infinity_is_read_only_where_it_is_allowed(file):
    assert parse_json("[-Infinity, 1]", file, ArmError, infinity=True) == [float("-inf"), 1]
    for text in ("[Infinity]", "[NaN]"):
        with pytest.raises(ArmError, match="expected a finite number"):
            parse_json(text, file, ArmError)
    with pytest.raises(ArmError, match="found NaN"):
        parse_json("NaN", file, ArmError, infinity=True)
