"""The picture of an arm's muscles."""

from dataclasses import replace

from drakearm.figures import draw_arm, write_arm_picture
from drakearm.model.inspection import inspect_arm


def test_picture_has_one_row_per_muscle_of_any_kind(small):
    figure = draw_arm(inspect_arm(small))
    texts = [text.get_text() for panel in figure.axes for text in panel.texts]
    assert len(figure.axes) == 5 * len(small.muscles)
    for text in (*small.muscle_names, "rigid tendon"):
        assert text in texts
    figure.canvas.draw()


def test_dollar_signs_in_a_name_are_shown(arm, tmp_path):
    muscles = (replace(arm.muscles[0], name="$x^$"),)  # as a formula, it would be an error
    write_arm_picture(inspect_arm(replace(arm, muscles=muscles)), tmp_path / "arm.png")
    assert (tmp_path / "arm.png").is_file()
