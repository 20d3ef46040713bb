"""The picture of a movement."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.image import imread

from drakearm.diagrams import MakePolicyLoop
from drakearm.experiments import evaluation_metrics
from drakearm.experiments.success import JointError
from drakearm.figures import Movement, draw_movement, write_movement_picture
from drakearm.model import MakeTorqueArm, Obstacle
from drakearm.model.skeleton import hand_motion
from tests.figures.layout import assert_axes_have_units, assert_legends_cover_nothing

CRITERIA = [JointError(of="mean", below=0.1)]


@pytest.fixture(scope="module")
def movement(task) -> Movement:
    loops = [MakePolicyLoop(task, lambda _, u=u: np.full(14, u)) for u in (0.02, 0.03, 0.04)]
    recording, *noisy = (loop.Run() for loop in loops)
    metrics = evaluation_metrics(task, recording, noisy, CRITERIA)
    return Movement(task, recording, noisy, metrics, "a $name$", "described")


def panel(figure, title):
    (found,) = [axes for axes in figure.axes if axes.get_title(loc="left").startswith(title)]
    return found


def test_it_is_written_as_a_png_that_is_not_blank(movement, tmp_path):
    write_movement_picture(movement, tmp_path / "movement.png")
    assert np.std(imread(tmp_path / "movement.png")[..., :3]) > 0.05


def test_lines_are_the_run_and_bands_are_the_runs_with_noise(movement):
    speed = panel(draw_movement(movement), "speed of the hand")
    np.testing.assert_array_equal(speed.lines[0].get_ydata(), movement.recording.hand_speed)
    (band,) = speed.collections
    fastest = max(run.hand_speed.max() for run in movement.noisy)
    assert band.get_paths()[0].vertices[:, 1].max() == pytest.approx(fastest)


def test_the_goal_of_the_hand_is_the_end_of_the_reference(movement, task):
    (circle,) = panel(draw_movement(movement), "path of the hand").patches
    goal, _ = hand_motion(MakeTorqueArm(task.arm), task.arm, task.reference.q[-1:], task.reference.v[-1:])
    assert circle.center == pytest.approx(goal[0, :2])


def test_axes_have_units_and_legends_cover_nothing(movement, task):
    barred = replace(task, obstacle=Obstacle(position=(0.33, 0.25, 0.17), radius=0.03))
    for one in (movement, movement._replace(task=barred)):
        figure = draw_movement(one)
        assert_axes_have_units(figure)
        assert_legends_cover_nothing(figure)


def test_what_is_missed_is_said_at_the_top(movement):
    texts = [text.get_text() for text in draw_movement(movement).texts]
    assert "a $name$" in texts and "Success: mean error NO (0% with noise)" in texts


def test_an_obstacle_is_drawn_and_a_run_alone_too(movement, task):
    barred = replace(task, obstacle=Obstacle(position=(0.33, 0.25, 0.17), radius=0.03))
    metrics = evaluation_metrics(barred, movement.recording, movement.noisy, CRITERIA)
    figure = draw_movement(movement._replace(task=barred, noisy=[], metrics=metrics))
    assert [patch.center for patch in panel(figure, "the arm").patches if hasattr(patch, "center")] == [(0.33, 0.25)]
    assert not panel(figure, "joint angles").collections
