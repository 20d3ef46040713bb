"""The table of an arm's muscles."""

from dataclasses import replace
from io import StringIO

from rich.console import Console

from drakearm.figures import muscle_table
from drakearm.model.inspection import inspect_arm
from drakearm.model.loader import load_limb
from tests.limbs import EXTENSOR, FLEXOR, write_limb


def printed(table, width=120):
    console = Console(width=width, file=StringIO())
    console.print(table)
    return console.file.getvalue()


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


def test_table_says_what_was_computed_of_the_file(tmp_path):
    sphere = {"name": "roll", "type": "sphere", "body": "base", "center": [0, 0, 0], "radius": 0.02}
    limb = load_limb(write_limb(tmp_path, (FLEXOR, {**EXTENSOR, "tendon_slack_length": 0.2}), (sphere,)))
    text = " ".join(printed(muscle_table(inspect_arm(*limb)), 200).split())
    assert "flexor, extensor: path functions that are fitted to the points, with errors of at most" in text
    assert "* extensor has a poor fit" in text and "* flexor has" not in text
    assert "flexor: slack lengths with which the fibers are optimal at elbow 69°, because the file gives none" in text


def test_square_brackets_in_a_name_are_shown(arm):
    muscles = (replace(arm.muscles[0], name="[red]"),)
    assert "[red]" in printed(muscle_table(inspect_arm(replace(arm, muscles=muscles))))
