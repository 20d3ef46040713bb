"""The drawn paths of muscles: through their points, and as long as the path functions say."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.math import RigidTransform

from drakearm.model import MakeTorqueArm, load_arm
from drakearm.model.musculature import muscle_geometry
from drakearm.systems.muscle_path import MusclePaths

POSTURES = [np.radians([s, e]) for s in (-60.0, -20.0, 0.0, 40.0, 105.0) for e in (0.0, 30.0, 80.0, 130.0)]
CLOSE = 5e-4  # m


@pytest.fixture(scope="module")
def arm():
    return load_arm()


def body_poses(plant, q) -> list[RigidTransform]:
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    return plant.get_body_poses_output_port().Eval(context)


def path_length(path):
    return np.linalg.norm(np.diff(path, axis=0), axis=1).sum()


@pytest.mark.parametrize("q", POSTURES, ids=lambda q: np.rad2deg(q).round().tolist())
def test_paths_are_as_long_as_the_path_functions_say(arm, q):
    plant = MakeTorqueArm(arm)
    paths = MusclePaths(plant, arm)(body_poses(plant, q))
    lengths = muscle_geometry(q, arm.muscle_table, arm.path_table)[0]
    np.testing.assert_allclose([path_length(path) for path in paths], lengths, atol=CLOSE)


def test_paths_begin_and_end_at_the_attachments(arm):
    plant = MakeTorqueArm(arm)
    X_WB = body_poses(plant, np.array([0.5, 1.0]))
    for muscle, path in zip(arm.muscles, MusclePaths(plant, arm)(X_WB), strict=True):
        ends = [X_WB[int(plant.GetBodyByName(b).index())].multiply(p) for b, p in (muscle.points[0], muscle.points[-1])]
        np.testing.assert_allclose(path[[0, -1]], ends, atol=1e-9)


def test_arcs_are_on_the_side_on_which_the_muscle_pulls(arm):
    """The brachialis bends the elbow: straight, it passes in front of it, whatever the order of its points."""
    plant = MakeTorqueArm(arm)
    X_WB = body_poses(plant, np.zeros(2))
    elbow = X_WB[int(plant.GetBodyByName("ulna").index())].translation()
    (muscle,) = (m for m in arm.muscles if m.name == "BRA")
    for points in (muscle.points, muscle.points[::-1]):
        one = replace(arm, muscles=(replace(muscle, points=points),))
        (path,) = MusclePaths(plant, one)(X_WB)
        nearest = path[np.argmin(np.abs(path[:, 1] - elbow[1]))]
        assert nearest[0] - elbow[0] > 0.005  # forward


def test_points_that_do_not_fit_the_path_function_give_a_bounded_path(arm):
    plant = MakeTorqueArm(arm)
    X_WB = body_poses(plant, np.array([0.5, 1.0]))
    muscle = arm.muscles[0]
    body, point = muscle.points[0]
    for points in (muscle.points[-2:], (muscle.points[0],) * 2, ((body, point), ("hand", (0.0, -0.1, 0.0)))):
        one = replace(arm, muscles=(replace(muscle, points=points),))
        (path,) = MusclePaths(plant, one)(X_WB)
        p_W = np.array([X_WB[int(plant.GetBodyByName(b).index())].multiply(p) for b, p in points])
        assert np.isfinite(path).all()
        assert path_length(path) < 2.5 * path_length(p_W) + 1e-9
