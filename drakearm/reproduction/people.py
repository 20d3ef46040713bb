"""How fast people move their hands: speed profiles of seven people, see `hug_mp/CREDITS.md`."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

PEOPLE = {
    "single_peaked_under_1.2s": "one peak, under 1.2 s",
    "under_1s": "under 1 s",
}  # groups of trials, for a reader
_FOLDER = Path(__file__).parent / "hug_mp"


@dataclass(frozen=True)
class People:
    """A group of movements of seven people. Profiles (101,) are speeds over their peak, cut like `speed_profile`."""

    label: str
    mean: np.ndarray  # over the people
    between: np.ndarray  # standard deviation between people
    within: np.ndarray  # standard deviation within one person
    duration: float  # s, mean
    peak_over_mean: float
    time_of_peak: float  # share of the duration
    ceiling: float  # the correlation of one person's mean profile with that of the others


def load_people(group: str) -> People:
    """The shipped profiles of a group of `PEOPLE`."""
    profiles = np.genfromtxt(_FOLDER / "speed_profiles.csv", delimiter=",", names=True, deletechars="")
    groups = np.genfromtxt(_FOLDER / "groups.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    row = groups[groups["group"] == group][0]
    return People(
        label=PEOPLE[group],
        mean=profiles[f"{group}_mean"],
        between=profiles[f"{group}_sd_between"],
        within=profiles[f"{group}_sd_within"],
        duration=float(row["duration"]),
        peak_over_mean=float(row["peak_over_mean"]),
        time_of_peak=float(row["time_of_peak"]),
        ceiling=float(row["correlation_of_one_with_others"]),
    )
