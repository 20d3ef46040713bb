"""Looks that can be told apart: in color, in gray, and at the low end of activations."""

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from drakearm.figures.labelled_lines import many_lines, spread
from drakearm.figures.raster import COLORMAP, TICKS, activation_norm
from drakearm.figures.style import POLICY, STATIC, joint_line


def lightness(rgb):
    """L* of CIELAB for colors (..., 3), sRGB: what remains of them in gray, 0 to 100."""
    linear = np.where(np.asarray(rgb) <= 0.04045, np.asarray(rgb) / 12.92, ((np.asarray(rgb) + 0.055) / 1.055) ** 2.4)
    y = linear @ [0.2126, 0.7152, 0.0722]
    return np.where(y > (6 / 29) ** 3, 116 * np.cbrt(y) - 16, y * (29 / 3) ** 3)


def of_activation(activation):
    return lightness(COLORMAP(activation_norm()(np.asarray(activation)))[..., :3])


def test_more_activation_is_darker_in_gray_too():
    assert np.all(np.diff(of_activation(np.linspace(0.0, 1.0, 200))) <= 0.0)


def test_the_steps_of_the_bar_can_be_told_apart_from_zero_on():
    assert np.all(np.diff(of_activation(TICKS)) < -5.0)
    assert TICKS[:2] == (0.0, 0.01)  # none, and at rest


def test_fourteen_muscles_have_fourteen_colors_and_neighbors_other_dashes():
    looks = many_lines(14)
    assert len({look["color"] for look in looks}) == 14
    assert all(a["linestyle"] != b["linestyle"] for a, b in pairwise(looks))
    assert np.all(lightness([to_rgb(look["color"]) for look in looks]) < 80.0)  # none is lost on white


def test_seven_joints_differ_in_more_than_color():
    looks = [joint_line(j) for j in range(7)]  # the most that an arm can have
    assert len({str(look) for look in looks}) == 7
    assert looks[0]["linestyle"] != looks[1]["linestyle"]
    assert POLICY["linestyle"] != STATIC["linestyle"] and POLICY["marker"] != STATIC["marker"]


@pytest.mark.parametrize("seed", range(5))
def test_names_of_lines_do_not_overlap(seed):
    places = np.random.default_rng(seed).normal(0.5, 0.2, size=14)
    found = spread(places, 0.05)
    assert np.all(np.diff(np.sort(found)) > 0.05 - 1e-9)
    assert found.min() >= 0.0 and found.max() <= 1.0 + 1e-9
    np.testing.assert_array_equal(np.argsort(found), np.argsort(places))


def test_names_that_have_room_stay_where_they_are():
    places = np.array([0.9, 0.1, 0.5])
    np.testing.assert_allclose(spread(places, 0.1), places)


def test_without_room_names_are_as_far_apart_as_possible():
    np.testing.assert_allclose(np.sort(spread(np.full(5, 0.3), 1.0)), np.linspace(0.0, 1.0, 5))
