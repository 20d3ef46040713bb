"""The minimum-jerk speed: its known peak, before and after the cut."""

import numpy as np
import pytest

from drakearm.reproduction.minimum_jerk import minimum_jerk_profile, minimum_jerk_speed


def test_speed_has_mean_1_and_the_known_peak_in_the_middle():
    phase = np.linspace(0.0, 1.0, 1001)
    speed = minimum_jerk_speed(phase)
    assert np.trapezoid(speed, phase) == pytest.approx(1.0, abs=1e-5)
    assert speed.max() == pytest.approx(1.875)
    assert phase[speed.argmax()] == 0.5


def test_the_cut_makes_the_profile_shorter_and_fuller():
    profile = minimum_jerk_profile()
    assert profile.peak_over_mean == pytest.approx(1.66, abs=0.005)
    assert profile.time_of_peak == pytest.approx(0.5, abs=1e-4)
    np.testing.assert_allclose(profile.speed[[0, 50, 100]], [0.05, 1.0, 0.05], atol=1e-6)
    np.testing.assert_allclose(profile.speed, profile.speed[::-1], atol=1e-6)
