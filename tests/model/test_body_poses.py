"""Poses of bodies at many postures are those of the plant."""

import numpy as np
import pytest

from drakearm.model import load_arm
from drakearm.model.body_poses import body_poses
from drakearm.model.skeleton import skeleton_plant
from tests.limbs import write_fork


@pytest.mark.parametrize("name", ["arm14", "fork"])
def test_poses_are_those_of_the_plant(name, tmp_path):
    plant = skeleton_plant(load_arm("arm14" if name == "arm14" else write_fork(tmp_path)))
    bodies = ["world", *("ulna", "hand", "r_humerus")] if name == "arm14" else ["world", "right", "left", "trunk"]
    q = np.random.default_rng(0).uniform(-3.0, 3.0, (5, plant.num_positions()))
    poses, context = body_poses(plant, bodies, q), plant.CreateDefaultContext()
    for k, angles in enumerate(q):
        plant.SetPositions(context, angles)
        for body in bodies:
            X_WB = plant.GetBodyByName(body).EvalPoseInWorld(context)
            np.testing.assert_allclose(poses[body].rotation[k], X_WB.rotation().matrix(), atol=1e-14)
            np.testing.assert_allclose(poses[body].position[k], X_WB.translation(), atol=1e-14)


def test_a_point_is_found_again_in_its_body(tmp_path):
    plant = skeleton_plant(load_arm(write_fork(tmp_path)))
    poses = body_poses(plant, ["left"], np.array([[0.3, -0.4, 0.5]]))["left"]
    np.testing.assert_allclose(poses.locate(poses.place(np.array([0.1, 0.2, 0.3]))), [[0.1, 0.2, 0.3]], atol=1e-14)
