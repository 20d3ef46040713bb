"""The picture of a plan, and the side view of the arm in it."""

import re
from dataclasses import replace
from io import StringIO

import numpy as np
import pytest
from matplotlib.image import imread
from rich.console import Console

from drakearm.experiments import RunFolder, plan_step
from drakearm.figures import SideView, draw_plan, plan_facts, plans_table
from drakearm.model import MakeTorqueArm
from drakearm.model.obstacle import Obstacle
from tests.figures.layout import assert_axes_have_units, assert_legends_cover_nothing


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
    texts = [text.get_text() for legend in draw_plan(lift[1]).legends for text in legend.texts]
    assert any(text.startswith("shoulder: the muscles lack up to 6") for text in texts)


def test_axes_have_units_and_legends_cover_nothing(obstacle, lift):
    for _, report in (obstacle, lift):
        figure = draw_plan(report)
        assert_axes_have_units(figure)
        assert_legends_cover_nothing(figure)


def test_legends_name_an_obstacle_only_if_there_is_one(obstacle, lift):
    for (_, report), there in ((obstacle, True), (lift, False)):
        texts = [text.get_text() for legend in draw_plan(report).legends for text in legend.texts]
        assert ("obstacle" in texts) is there
        assert "path of the hand" in texts


def test_zero_has_no_sign(lift):
    """The elbow starts at its limit, so that its margin is 0, or less by a rounding error."""
    report = replace(lift[1], plan=replace(lift[1].plan, verification=replace(
        lift[1].plan.verification, angle_margin=-1e-12, speed_margin=-1e-9, torque_margin=-0.0, clearance=-1e-9,
        nearest_part="hand", nearest_time=0.0,
    )))  # fmt: skip
    console = Console(width=120, file=StringIO())
    console.print(plan_facts(report), plans_table({"lift": report}))
    shown = [console.file.getvalue(), *(text.get_text() for text in draw_plan(report).texts)]
    assert "0.0°" in shown[0]
    assert not [text for text in shown if re.search(r"-0(\.0*)?(?![\d.])", text)]


def test_activations_are_in_the_order_of_the_roles(lift):
    figure, report = draw_plan(lift[1]), lift[1]
    (raster,) = [panel for panel in figure.axes if panel.get_title(loc="left").startswith("activations")]
    names = [label.get_text() for label in raster.get_yticklabels()]
    assert sorted(names) == sorted(report.arm.muscle_names) and names != list(report.arm.muscle_names)
    for name, row in zip(names, raster.images[0].get_array(), strict=True):
        np.testing.assert_array_equal(row, report.feasibility.activation[:, report.arm.muscle_names.index(name)])


@pytest.mark.parametrize("obstacle", [None, Obstacle(position=(0.3, 0.2, 0.1), radius=0.02, axis=(0.0, 0.0, -2.0))])
def test_side_view_is_of_forward_and_up(arm, obstacle):
    view, q = SideView(arm, obstacle), np.array([0.3, 1.2])
    plant = MakeTorqueArm(arm)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    tip = plant.GetFrameByName("hand_tip").CalcPoseInWorld(context).translation()
    np.testing.assert_allclose(view.stick(q)[-1], tip[:2], atol=1e-12)
    np.testing.assert_allclose(view.project(np.array([1.0, 2.0, 3.0])), [1.0, 2.0])
    assert view.labels == ("x (m)", "y (m)")
    assert [radius for _, _, radius in view.outline(q)] == [part.radius for part in arm.outline]


def test_a_view_along_no_axis_of_the_world_names_directions(arm):
    view = SideView(arm, Obstacle(position=(0.3, 0.2, 0.1), radius=0.02, axis=(1.0, 0.0, 1.0)))
    assert view.labels == ("to the right (m)", "y (m)")
