"""Speed profiles: rest around a movement does not matter, and the numbers of known shapes."""

import numpy as np
import pytest

from drakearm.reproduction.minimum_jerk import minimum_jerk_profile, minimum_jerk_speed
from drakearm.reproduction.speed_profile import correlation, path_deviation, speed_profile


@pytest.mark.parametrize("before, duration, after, peak", [(0.0, 0.5, 0.25, 0.4), (0.2, 0.9, 0.0, 3.0)])
def test_profile_does_not_depend_on_rest_duration_or_height(before, duration, after, peak):
    t = np.arange(0.0, before + duration + after + 1e-9, 0.01)
    phase = np.clip((t - before) / duration, 0.0, 1.0)
    profile = speed_profile(t, peak / 1.875 * minimum_jerk_speed(phase))
    expected = minimum_jerk_profile()
    np.testing.assert_allclose(profile.speed, expected.speed, atol=0.01)
    assert profile.peak_over_mean == pytest.approx(expected.peak_over_mean, abs=0.01)
    assert profile.time_of_peak == pytest.approx(0.5, abs=0.01)
    assert profile.duration == pytest.approx(duration * expected.duration, abs=0.01)
    assert profile.onset == pytest.approx(before + duration * expected.onset, abs=0.01)


def test_movement_is_the_part_around_the_peak():
    t = np.linspace(0.0, 2.0, 201)
    two = np.where(t < 1.0, np.sin(np.pi * t), 0.5 * np.sin(np.pi * (t - 1.0)))  # it comes to rest in between
    profile = speed_profile(t, np.maximum(two, 0.0))
    assert profile.end == pytest.approx(1.0, abs=0.02)
    assert profile.peak_over_mean == pytest.approx(np.pi / 2, abs=0.05)


def test_hand_that_does_not_slow_down_moves_until_the_last_sample():
    t = np.linspace(0.0, 1.0, 101)
    profile = speed_profile(t, t)
    assert (profile.onset, profile.end) == (pytest.approx(0.05), 1.0)
    assert profile.time_of_peak == 1.0


def test_correlation_with_itself_is_1_and_with_its_mirror_image_minus_1():
    speed = minimum_jerk_profile().speed
    assert correlation(speed, 3.0 * speed + 1.0) == pytest.approx(1.0)
    assert correlation(speed, -speed) == pytest.approx(-1.0)


def test_path_deviation_of_a_line_and_of_a_half_circle():
    angle = np.linspace(0.0, np.pi, 181)
    circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    assert path_deviation(circle) == pytest.approx(0.5)
    assert path_deviation(angle[:, None] * np.array([1.0, -2.0, 0.5])) == pytest.approx(0.0, abs=1e-12)
