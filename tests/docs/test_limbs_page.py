"""The page about limbs names every field of a muscle, with its default."""

import re
from dataclasses import MISSING, fields
from pathlib import Path

from drakearm.model import Muscle

PAGE = (Path(__file__).parents[2] / "docs" / "limbs.md").read_text(encoding="utf-8")


def table(heading: str) -> list[list[str]]:
    """The cells of a table's rows, by the first words of its heading."""
    rows = PAGE.partition(f"| {heading} |")[2].partition("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


def test_every_field_of_a_muscle_is_in_the_tables():
    names = [
        name
        for row in table("field of a muscle") + table("more fields of a muscle")
        for name in re.findall(r"`(\w+)`", row[0])
    ]
    assert sorted(names) == sorted(field.name for field in fields(Muscle))


def test_defaults_are_those_of_the_dataclass():
    defaults = {field.name: field.default for field in fields(Muscle)}
    for name, _, default, _ in table("more fields of a muscle"):
        expected = defaults[name.strip("`")]
        assert expected is not MISSING
        assert default.strip("`") == ("" if expected == () else str(expected)), name
