"""The order of muscles: by the joints that they cross, and by what their moment arms say."""

from dataclasses import replace

import numpy as np

from drakearm.figures.muscle_roles import muscle_roles
from drakearm.model.musculature import muscle_geometry


def names(arm, role):
    return [arm.muscle_names[i] for i in role.muscles]


def test_the_roles_of_the_arm(arm):
    assert [(role.label, names(arm, role)) for role in muscle_roles(arm)] == [
        ("shoulder ↑ elbow ↑", ["BIClong"]),
        ("shoulder ↕ elbow ↑", ["BICshort"]),
        ("shoulder ↓ elbow ↓", ["TRIlong"]),
        ("elbow ↑", ["BRA", "BRD", "ECRL", "FCR", "FCU", "PL"]),
        ("elbow ↕", ["ECRB"]),
        ("elbow ↓", ["TRIlat", "TRImed", "ANC", "ECU"]),
    ]


def test_every_muscle_has_one_role_whatever_their_order_is(arm):
    turned = replace(arm, muscles=arm.muscles[::-1])
    roles, others = muscle_roles(arm), muscle_roles(turned)
    assert sorted(i for role in roles for i in role.muscles) == list(range(len(arm.muscles)))
    assert [set(names(arm, role)) for role in roles] == [set(names(turned, role)) for role in others]


def test_a_pull_is_the_sign_of_the_moment_arm(arm):
    q = np.deg2rad([20.0, 60.0])
    arms = muscle_geometry(q, arm.muscle_table, arm.path_table)[1]
    for role in muscle_roles(arm):
        for joint, pull in role.pulls.items():
            if pull:
                values = arms[list(role.muscles), arm.coordinates.index(joint)]
                np.testing.assert_array_equal(np.sign(values), pull)


def test_muscles_of_two_joints_are_between_those_of_one(arm):
    """Here the muscles of the elbow are copied to the shoulder."""
    at_shoulder = [
        replace(m, name=f"S{m.name}", path=tuple(replace(term, coordinate="shoulder") for term in m.path))
        for m in arm.muscles
        if len(m.path) == 1
    ]
    roles = muscle_roles(replace(arm, muscles=(*arm.muscles, *at_shoulder)))
    joints = [tuple(role.pulls) for role in roles]
    assert joints == sorted(joints, key=[("shoulder",), ("shoulder", "elbow"), ("elbow",)].index)
    assert len(set(joints)) == 3
    for pair in set(joints):
        pulls = [list(role.pulls.values())[-1] for role in roles if tuple(role.pulls) == pair]
        assert pulls == sorted(pulls, reverse=True)
