"""The picture of an arm's muscles."""

from dataclasses import replace

import pytest
from matplotlib import rc_context

from drakearm.errors import StorageError
from drakearm.figures import draw_arm, write_arm_picture
from drakearm.model.inspection import inspect_arm
from tests.figures.layout import assert_legends_cover_nothing, legend_texts
from tests.full_disk import full_disk


def test_picture_has_one_row_per_muscle_of_any_kind(small):
    figure = draw_arm(inspect_arm(small))
    texts = [text.get_text() for panel in figure.axes for text in panel.texts]
    assert len(figure.axes) == 5 * len(small.muscles)
    for text in (*small.muscle_names, "rigid tendon"):
        assert text in texts
    figure.canvas.draw()


def test_legends_say_what_is_drawn_and_cover_nothing(arm, small):
    figure = draw_arm(inspect_arm(arm))
    assert_legends_cover_nothing(figure)
    assert [legend_texts(panel) for panel in figure.axes[:5]] == [
        ["shoulder", "elbow", "at all angles of the other joints", "beyond the fitted path"],
        ["shoulder", "elbow", "beyond the fitted path"],
        ["active, full activation", "passive", "working range"],
        ["full activation", "activation 0.05"],
        ["working range"],
    ]
    brachialis = replace(arm, muscles=(arm.muscles[arm.muscle_names.index("BRA")],))  # of the elbow, fitted everywhere
    figure = draw_arm(inspect_arm(brachialis))
    assert [legend_texts(panel) for panel in figure.axes[:2]] == [["elbow"], ["elbow"]]
    slack, rigid = (replace(small, muscles=(small.muscles[i],)) for i in (1, 2))  # slack everywhere; rigid tendon
    lengths, _, forces, _, tendon = draw_arm(inspect_arm(slack)).axes
    assert "no equilibrium" in legend_texts(lengths) and "working range" not in legend_texts(forces)
    assert legend_texts(tendon) == [] and legend_texts(draw_arm(inspect_arm(rigid)).axes[4]) == []


def test_joints_differ_in_gray(arm):
    lengths = draw_arm(inspect_arm(arm)).axes[0]
    styles = {line.get_label(): line.get_linestyle() for line in lengths.lines}
    assert styles["shoulder"] != styles["elbow"]


@pytest.mark.parametrize("name", ["$x^$", "$\\badcommand{$", r"\input{x}", "[/red]", "a_b^c", "%", "&"])
@pytest.mark.parametrize("settings", [{}, {"text.usetex": True, "text.parse_math": True}], ids=["plain", "latex"])
def test_names_are_shown_as_they_are(arm, tmp_path, name, settings):
    """As a formula or as LaTeX code, some of them would be errors."""
    muscles = (replace(arm.muscles[0], name=name),)
    with rc_context(settings):  # a user's own
        write_arm_picture(inspect_arm(replace(arm, name=name, muscles=muscles)), tmp_path / "arm.png")
    assert (tmp_path / "arm.png").read_bytes().startswith(b"\x89PNG")


def test_a_full_disk_leaves_the_earlier_picture(arm, tmp_path):
    picture = tmp_path / "arm.png"
    picture.write_text("an earlier picture")
    inspection = inspect_arm(replace(arm, muscles=arm.muscles[:1]))
    with full_disk(), pytest.raises(StorageError, match=r"arm.png cannot be written: File too large"):
        write_arm_picture(inspection, picture)
    assert picture.read_text() == "an earlier picture"
    assert list(tmp_path.iterdir()) == [picture]
