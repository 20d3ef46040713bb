"""The muscle load: which muscles count, and which share of the time."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.reproduction.muscle_load import muscle_groups, muscle_load


def names(arm, muscles):
    return {arm.muscle_names[i] for i in muscles}


def test_groups_are_the_anatomical_ones(arm, reference):
    elbow = muscle_groups(arm, arm.coordinates.index("elbow"), reference.q)
    assert {"BIClong", "BICshort", "BRA", "BRD"} <= names(arm, elbow.flexors)
    assert {"TRIlong", "TRIlat", "TRImed", "ANC"} <= names(arm, elbow.extensors)
    assert len(elbow.flexors) + len(elbow.extensors) == len(arm.muscles)


def test_muscles_that_do_not_cross_the_joint_belong_to_no_group(arm, reference):
    shoulder = muscle_groups(arm, arm.coordinates.index("shoulder"), reference.q)
    assert names(arm, [*shoulder.flexors, *shoulder.extensors]) == {"TRIlong", "BIClong", "BICshort"}


def test_load_is_the_share_of_time_above_80_percent(runs):
    activation = np.zeros_like(runs[0].activation)
    quarter = len(activation) // 4
    activation[:quarter, 0], activation[:, 1], activation[:, 2] = 0.81, 0.8, 1.0
    recording = replace(runs[0], activation=activation)
    assert muscle_load(recording, np.array([0])) == pytest.approx(quarter / len(activation))
    assert muscle_load(recording, np.array([1])) == 0.0
    assert muscle_load(recording, np.array([1, 2])) == 0.5
