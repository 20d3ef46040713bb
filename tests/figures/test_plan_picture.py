"""The picture of a plan, and the side view of the arm in it."""

import numpy as np
import pytest
from matplotlib.image import imread

from drakearm.experiments import RunFolder, plan_step
from drakearm.figures import SideView, draw_plan
from drakearm.model import MakeTorqueArm
from drakearm.model.obstacle import Obstacle


@pytest.fixture(scope="module")
def obstacle(tmp_path_factory):
    run = RunFolder(tmp_path_factory.mktemp("obstacle"))
    return run, plan_step(run, "obstacle")


@pytest.fixture(scope="module")
def lift(tmp_path_factory):
    run = RunFolder(tmp_path_factory.mktemp("lift"))
    return run, plan_step(run, "lift-20kg")


def test_picture_is_a_png(obstacle, lift):
    for run, _ in (obstacle, lift):
        assert run.path("plan_picture").read_bytes().startswith(b"\x89PNG")
        assert np.std(imread(run.path("plan_picture"))[..., :3]) > 0.05  # not blank


def test_picture_draws_the_obstacle_where_it_is_and_what_the_muscles_lack(obstacle, lift):
    (circle,) = [patch for panel in draw_plan(obstacle[1]).axes for patch in panel.patches if hasattr(patch, "radius")]
    assert circle.center == pytest.approx((0.33, 0.25)) and circle.radius == 0.03
    texts = [text.get_text() for panel in draw_plan(lift[1]).axes if panel.legend_ for text in panel.legend_.texts]
    assert any(text.startswith("shoulder: the muscles lack up to 6") for text in texts)


@pytest.mark.parametrize("obstacle", [None, Obstacle(position=(0.3, 0.2, 0.1), radius=0.02, axis=(0.0, 0.0, -2.0))])
def test_side_view_is_of_forward_and_up(arm, obstacle):
    view, q = SideView(arm, obstacle), np.array([0.3, 1.2])
    plant = MakeTorqueArm(arm)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    tip = plant.GetFrameByName("hand_tip").CalcPoseInWorld(context).translation()
    np.testing.assert_allclose(view.stick(q)[-1], tip[:2], atol=1e-12)
    np.testing.assert_allclose(view.project(np.array([1.0, 2.0, 3.0])), [1.0, 2.0])
    assert [radius for _, _, radius in view.outline(q)] == [part.radius for part in arm.outline]
