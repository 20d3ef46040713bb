"""Paths over cylinders and spheres against lengths that are known, and their continuity where they begin to touch."""

import numpy as np
import pytest

from drakearm.model.wrapping import path_over_cylinder, path_over_sphere, turn_on_side

R = 0.02


def over_cylinder(p, q, turn=1.0):
    length, contact = path_over_cylinder(np.atleast_2d(p), np.atleast_2d(q), R, turn)
    return float(length[0]), float(contact[0])


def over_sphere(p, q, side=None):
    length, contact = path_over_sphere(np.atleast_2d(p), np.atleast_2d(q), R, side)
    return float(length[0]), float(contact[0])


def around(angle, distance=0.1, z=0.0):
    return np.array([distance * np.cos(angle), distance * np.sin(angle), z])


@pytest.mark.parametrize("over", [over_cylinder, over_sphere])
def test_a_rope_over_half_a_pulley(over):
    """Two vertical lines of 0.1 m and half a circle."""
    length, contact = over([R, -0.1, 0.0], [-R, -0.1, 0.0], *([np.array([0, 1.0, 0])] if over is over_sphere else []))
    assert length == pytest.approx(0.2 + np.pi * R, abs=1e-15)
    assert contact == pytest.approx(np.pi, abs=1e-12)


@pytest.mark.parametrize("over", [over_cylinder, over_sphere])
def test_a_rope_over_a_quarter_of_a_pulley(over):
    """A line along -y, a quarter of a circle, and a line along x: a right angle."""
    length, contact = over([R, -0.1, 0.0], [-0.1, R, 0.0], *([np.array([1.0, 1, 0])] if over is over_sphere else []))
    assert length == pytest.approx(0.2 + 0.5 * np.pi * R, abs=1e-15)
    assert contact == pytest.approx(0.5 * np.pi, abs=1e-12)


@pytest.mark.parametrize("over", [over_cylinder, over_sphere])
def test_a_line_that_misses_the_surface_is_straight(over):
    p, q = np.array([0.05, -0.1, 0.03]), np.array([0.04, 0.1, -0.02])
    length, contact = over(p, q)
    assert length == pytest.approx(np.linalg.norm(p - q), abs=1e-15)
    assert contact < 0.0


def test_a_helix_over_a_cylinder_is_as_long_as_on_the_unrolled_one():
    flat = 0.2 + 0.5 * np.pi * R
    assert over_cylinder([R, -0.1, 0.0], [-0.1, R, 0.3])[0] == pytest.approx(np.hypot(flat, 0.3), abs=1e-15)


@pytest.mark.parametrize("over", [over_cylinder, over_sphere])
def test_the_length_grows_along_a_unit_vector_whose_line_touches_the_surface(over):
    """This defines shortest paths: the gradient of a distance has length 1 (the eikonal equation)."""
    rng, touching = np.random.default_rng(0), 0
    for p, q in rng.uniform(-0.1, 0.1, (500, 2, 3)):
        if min(np.hypot(*p[:2]), np.hypot(*q[:2])) < R:
            continue
        _, contact = over(p, q)
        gradient = np.array([over(p, q + d)[0] - over(p, q - d)[0] for d in 1e-6 * np.eye(3)]) / 2e-6
        assert np.linalg.norm(gradient) == pytest.approx(1.0, abs=1e-6)
        if contact > 0.0:
            touching += 1
            axes = slice(0, 2) if over is over_cylinder else slice(0, 3)
            along = gradient[axes] / np.linalg.norm(gradient[axes])
            distance = np.linalg.norm(q[axes] - (q[axes] @ along) * along)
            assert distance == pytest.approx(R, abs=1e-6)
    assert touching > 10


@pytest.mark.parametrize("over", [over_cylinder, over_sphere])
def test_length_and_slope_are_continuous_where_the_path_begins_to_touch(over):
    """The second point turns around the axis. The slope by this angle is the distance of the line from the center."""
    start = around(-0.2)
    touching = -0.2 + 2.0 * np.arccos(R / 0.1)
    step = 1e-6
    before, at, after = (over(start, around(touching + d))[0] for d in (-step, 0.0, step))
    assert (at - before) / step == pytest.approx(R, rel=1e-4)
    assert (after - at) / step == pytest.approx(R, rel=1e-4)


def test_a_path_stays_on_its_side_of_a_cylinder():
    """The straight line crosses the axis while the second point turns, and the length goes on growing by R per rad."""
    lengths = [over_cylinder(around(0.0), around(angle))[0] for angle in np.linspace(2.9, 3.4, 6)]
    np.testing.assert_allclose(np.diff(lengths), R * 0.1, rtol=1e-9)


def test_a_path_over_a_sphere_slides_to_the_shorter_way_unless_it_has_a_side():
    short, long = (over_sphere(around(0.0), around(angle))[0] for angle in (3.0, 2.0 * np.pi - 3.0))
    assert short == pytest.approx(long)
    sides = [over_sphere(around(0.0), around(angle), np.array([0.0, 1.0, 0.0]))[0] for angle in (3.0, 3.2, 3.4)]
    np.testing.assert_allclose(np.diff(sides), R * 0.2, rtol=1e-9)


def test_the_turn_is_the_shorter_one_or_that_on_the_side():
    p, q = around(0.0), around(2.0)
    assert turn_on_side(p, q, None) == 1.0 and turn_on_side(q, p, None) == -1.0
    assert turn_on_side(p, q, np.array([0.0, 1.0, 0.0])) == 1.0
    assert turn_on_side(p, q, np.array([0.0, -1.0, 0.0])) == -1.0
