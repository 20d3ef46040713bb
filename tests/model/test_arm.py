"""Limits of an arm's numbers: plausible limbs are inside of them, and what has no solution is outside."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from drakearm.model import Muscle, PathTerm, load_arm

ARM = load_arm("arm14")
MUSCLE = ARM.muscles[3]
KNOTS = (0.0, 0.0, 1.0, 2.0, 2.0)  # of a spline of degree 1 with 3 coefficients


@pytest.mark.parametrize(
    ("field", "least", "most"),
    [
        ("max_isometric_force", 1e-6, 1e6),
        ("optimal_fiber_length", 1e-5, 10.0),
        ("tendon_slack_length", 1e-6, 10.0),
        ("pennation_angle", 0.0, 1.399),
        ("max_contraction_velocity", 0.1, 100.0),
        ("activation_time", 1e-3, 10.0),
        ("deactivation_time", 1e-3, 10.0),
        ("minimum_activation", 1e-4, 0.99),
        ("tendon_strain", 1e-3, 1.0),
        ("passive_strain", 0.05, 10.0),
        ("passive_shape", 0.1, 20.0),
        ("active_width", 0.05, 10.0),
        ("force_velocity_shape", 0.01, 10.0),
        ("eccentric_force", 1.1, 10.0),
        ("specific_tension", 1e3, 1e8),
        ("slow_twitch_fraction", 0.0, 1.0),
    ],
)
def test_each_number_has_limits(field, least, most):
    rigid = replace(MUSCLE, tendon="rigid")
    for value in (least, most):
        assert getattr(replace(rigid, **{field: value}), field) == value
    for value in (least - 1e-3 * abs(least) - 1e-9, 1.001 * most, np.nan, np.inf, -np.inf, 1e300, True, "1.0", None):
        with pytest.raises(ValidationError, match=field):
            replace(rigid, **{field: value})


@pytest.mark.parametrize("scale", [0.01, 1.0, 10.0])
def test_limbs_of_insects_and_elephants_are_inside(scale):
    """Lengths scale with the animal, and forces with its cross sections."""
    for muscle in ARM.muscles:
        replace(
            muscle,
            max_isometric_force=scale**2 * muscle.max_isometric_force,
            optimal_fiber_length=scale * muscle.optimal_fiber_length,
            tendon_slack_length=scale * muscle.tendon_slack_length,
        )


def test_a_compliant_tendon_stretches_by_a_part_of_the_fiber():
    """The shortest tendon of published arms, of pectoralis major (Holzbaur 2005), is inside."""
    pectoralis = {"optimal_fiber_length": 0.1442, "tendon_slack_length": 0.0028}
    replace(MUSCLE, **pectoralis)
    replace(MUSCLE, optimal_fiber_length=0.1, tendon_slack_length=0.1, tendon_strain=1e-3)
    replace(MUSCLE, tendon="rigid", tendon_slack_length=1e-4)
    with pytest.raises(ValidationError, match=r"tendon that stretches by 3.3e-06 m .* expected at least .* rigid"):
        replace(MUSCLE, tendon_slack_length=1e-4)
    with pytest.raises(ValidationError, match="tendon_strain"):
        replace(MUSCLE, tendon_strain=1e-9)


@pytest.mark.parametrize(
    "knots",
    [
        (0.0, 0.0, 1.0, 2.0, 2.0),
        (0.0, 0.5, 1.0, 1.5, 2.0),
        (-100.0, -100.0, 1.0, 100.0, 100.0),
        (0.0, 0.0, 2e-6, 2.0, 2.0),
    ],
)
def test_knots_of_a_spline(knots):
    assert PathTerm("elbow", knots, (0.3, 0.3, 0.3)).spline.k == 1


@pytest.mark.parametrize(
    ("knots", "expected"),
    [
        ((0.0, 0.0, 0.0, 2.0, 2.0), "given at most 1 times"),
        ((0.0, 0.0, 5e-7, 2.0, 2.0), "1e-06 rad apart"),
        ((0.0, 1.0, 0.5, 2.0, 2.0), "ascending"),
        ((1.0,) * 5, "ascending"),
        ((0.0, 0.0, 1.0, 2.0, 101.0), "100"),
        ((0.0, 0.0, np.nan, 2.0, 2.0), "-100"),
        ((0.0, 1.0, 2.0, 3.0), "at least 5 knots"),
        (tuple(np.linspace(0.0, 1.0, 17)), "at most 16"),
        (tuple(np.linspace(0.0, 1.0, 1001)), "1000"),
    ],
)
def test_knots_that_make_no_spline_are_refused(knots, expected):
    with pytest.raises(ValidationError, match=expected):
        PathTerm("elbow", knots, (0.3, 0.3, 0.3))


def test_a_moment_arm_is_at_most_100_m():
    PathTerm("elbow", KNOTS, (-100.0, 0.0, 100.0))
    with pytest.raises(ValidationError, match=r"moment arms of up to 101 m"):
        PathTerm("elbow", (0.0, 0.0, 0.99, 2.0, 2.0), (-100.0, 0.0, 100.0))


def test_an_arm_has_at_most_7_coordinates_each_once():
    many = tuple(f"j{i}" for i in range(5))
    replace(ARM, coordinates=(*ARM.coordinates, *many))
    with pytest.raises(ValidationError, match="coordinates"):
        replace(ARM, coordinates=(*ARM.coordinates, *many, "j5"))
    with pytest.raises(ValidationError, match="elbow is given twice"):
        replace(ARM, coordinates=(*ARM.coordinates, "elbow"))
    with pytest.raises(ValidationError, match="elbow is given twice"):
        replace(MUSCLE, path=(PathTerm("elbow", KNOTS, (0.3, 0.3, 0.3)),) * 2)


@pytest.mark.parametrize("name", ["", " elbow", "el\nbow", "el\x1b[2Jbow", "el\u202ebow", "e" * 101, 7, None])
def test_names_are_printable_and_short(name):
    assert isinstance(replace(MUSCLE, name="e" * 100), Muscle)
    for make in (
        lambda: replace(MUSCLE, name=name),
        lambda: replace(ARM, name=name),
        lambda: replace(ARM, tip_frame=name),
        lambda: PathTerm(name, KNOTS, (0.3, 0.3, 0.3)),
    ):
        with pytest.raises(ValidationError):
            make()


def test_gravity_and_positions_have_limits():
    replace(ARM, gravity=(0.0, -1000.0, 0.0))
    for gravity in ((0.0, -1001.0, 0.0), (0.0, np.nan, 0.0), (0.0, 0.0)):
        with pytest.raises(ValidationError, match="gravity"):
            replace(ARM, gravity=gravity)
    replace(MUSCLE, points=(("hand", (0.0, 100.0, 0.0)),))
    for point in (("hand", (0.0, 101.0, 0.0)), ("hand", (0.0, 0.0)), ("hand",), ("", (0.0, 0.0, 0.0))):
        with pytest.raises(ValidationError, match="points"):
            replace(MUSCLE, points=(point,))
