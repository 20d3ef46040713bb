"""The shipped hindlimb of a rat: its geometry, what its muscles do, and that its small inertias are stable."""

import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder

from drakearm.diagrams import AddMuscleArm, MakeSimulator
from drakearm.model import load_arm
from drakearm.model.joint_stops import STOP_DAMPING, STOP_STIFFNESS, stop_strength
from drakearm.model.loader import load_limb
from drakearm.model.musculature import muscle_geometry
from drakearm.model.skeleton import position_ranges, skeleton_plant

# What the muscles do at hip, knee and ankle while the rat stands: 1 bends a joint, -1 stretches it.
ROLES = {
    "IP": (1, 0, 0),
    "BFa": (-1, 0, 0),
    "CF": (-1, 0, 0),
    "SM": (-1, 1, 0),
    "BFp": (-1, 1, 0),
    "RF": (1, -1, 0),
    "VL": (0, -1, 0),
    "VM": (0, -1, 0),
    "VI": (0, -1, 0),
    "MG": (0, 1, -1),
    "LG": (0, 1, -1),
    "Pla": (0, 1, -1),
    "Sol": (0, 0, -1),
    "TA": (0, 0, 1),
    "EDL": (0, 0, 1),
}


@pytest.fixture(scope="module")
def rat():
    return load_arm("rat_hindlimb")


def test_segments_have_the_published_lengths_and_the_standing_rat_touches_the_ground(rat):
    plant = skeleton_plant(rat)
    context = plant.CreateDefaultContext()
    hip, knee, ankle, toe = (
        plant.GetFrameByName(name).CalcPoseInWorld(context).translation()
        for name in ("femur", "knee_center", "tibia", "toe")
    )
    lengths = [np.linalg.norm(b - a) for a, b in ((hip, knee), (knee, ankle), (ankle, toe))]
    np.testing.assert_allclose(lengths, [0.0318, 0.0387, 0.033], atol=1e-4)
    assert abs(toe[1]) < 2e-3 < ankle[1] < knee[1] < hip[1]


def test_muscles_have_their_roles_at_all_angles(rat):
    lower, upper = position_ranges(skeleton_plant(rat))
    for q in np.random.default_rng(0).uniform(lower, upper, (200, 3)):
        _, arms = muscle_geometry(q, rat.muscle_table, rat.path_table)
        assert np.abs(arms).max() < 0.017
        for name, arm, roles in zip(rat.muscle_names, arms, ROLES.values(), strict=True):
            for joint, role in zip(arm, roles, strict=True):
                assert role * joint > 2e-4 if role else abs(joint) < 2e-4, f"{name} at {np.rad2deg(q)}: {arm}"
    assert rat.muscle_names == tuple(ROLES)


def test_paths_follow_the_points_closely():
    for name, fit in load_limb("rat_hindlimb").fitted.items():
        assert fit.is_good and fit.moment_arm_share < 0.01, name


def test_stops_of_light_limbs_are_weaker(arm, rat):
    stiffness, damping = stop_strength(arm)
    np.testing.assert_array_equal(stiffness, STOP_STIFFNESS)
    np.testing.assert_array_equal(damping, STOP_DAMPING)
    stiffness, damping = stop_strength(rat)
    assert (stiffness < 10.0).all() and (damping < 0.01).all() and (np.diff(stiffness) < 0.0).all()


@pytest.mark.parametrize(
    ("active", "excitation"),
    [(("IP", "RF", "TA", "EDL"), 1.0), (("VL", "VM", "VI"), 1.0), (("BFa", "CF", "SM", "BFp"), 0.3), ((), 0.0)],
)
def test_stops_hold_the_joints_against_active_muscles(rat, active, excitation):
    """The limb ends at rest, at most 12 degrees beyond its ranges, in the usual time steps."""
    builder = DiagramBuilder()
    limb = AddMuscleArm(builder, rat)
    builder.ExportInput(limb.muscles.GetInputPort("excitation"), "excitation")
    diagram = builder.Build()
    simulator = MakeSimulator(diagram)
    context = simulator.get_mutable_context()
    diagram.GetInputPort("excitation").FixValue(context, [excitation * (name in active) for name in rat.muscle_names])
    limb.SetState(context, np.zeros(3))
    lower, upper = position_ranges(limb.plant)
    for k in range(1, 51):
        simulator.AdvanceTo(0.01 * k)
        q, v = np.split(limb.plant.GetPositionsAndVelocities(limb.plant.GetMyContextFromRoot(context)), 2)
        assert (q > lower - np.deg2rad(12.0)).all() and (q < upper + np.deg2rad(12.0)).all()
    assert np.abs(v).max() < 0.5
