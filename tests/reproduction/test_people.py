"""The shipped profiles of people have the numbers of their source."""

from pathlib import Path

import numpy as np
import pytest

import drakearm.reproduction
from drakearm.reproduction.minimum_jerk import minimum_jerk_profile
from drakearm.reproduction.people import PEOPLE, load_people
from drakearm.reproduction.speed_profile import correlation


@pytest.mark.parametrize(
    "group, with_minimum_jerk, ceiling", [("single_peaked_under_1.2s", 0.972, 0.983), ("under_1s", 0.974, 0.985)]
)
def test_correlations_are_those_of_the_source(group, with_minimum_jerk, ceiling):
    people = load_people(group)
    assert correlation(people.mean, minimum_jerk_profile().speed) == pytest.approx(with_minimum_jerk, abs=5e-4)
    assert people.ceiling == ceiling


@pytest.mark.parametrize("group", PEOPLE)
def test_profiles_are_cut_and_fit_their_numbers(group):
    people = load_people(group)
    assert people.mean.shape == people.between.shape == people.within.shape == (101,)
    assert 0.05 <= people.mean[0] < 0.06 and 0.05 <= people.mean[-1] < 0.06
    assert np.all(people.between < people.within)
    assert people.mean.argmax() / 100 == pytest.approx(people.time_of_peak, abs=0.02)


def test_the_licence_of_the_data_is_shipped_with_them():
    credits = (Path(drakearm.reproduction.__file__).parent / "hug_mp" / "CREDITS.md").read_text()
    assert "Copyright (c) 2025 TUM Chair of Information-oriented Control" in credits
    assert "Permission is hereby granted, free of charge" in credits
