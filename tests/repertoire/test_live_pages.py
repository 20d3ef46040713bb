"""The pages that simulate, in a browser: a person's clicks change the scene, and the lag is shown.

The page and the simulation are not in two threads: the browser is a process of its own, and each test takes turns.
"""

import time

import numpy as np
import pytest

from drakearm.experiments import load_scenario
from drakearm.experiments.catalog import POLICIES
from drakearm.model import MakeTorqueArm, load_arm
from drakearm.repertoire.driver import find_driver
from drakearm.repertoire.live import REACH, Live
from drakearm.repertoire.live_page import FRAME, LAG, STOP, LivePage
from drakearm.repertoire.live_replay import LOAD, PLAY, SPEED, LiveReplay, X, Y
from drakearm.repertoire.planned import PlannedMovement
from drakearm.repertoire.shipped import policy_and_repertoire
from tests.browser import needs_chromium, visit

pytestmark = [pytest.mark.slow, pytest.mark.extra, needs_chromium]


def until(page, condition, step):
    """Simulates and waits until the page is as expected."""
    deadline = time.monotonic() + 120.0
    while not page.evaluate(condition):
        assert time.monotonic() < deadline, condition
        step()
        page.wait_for_timeout(20)


def open_controls(page):
    page.locator(".close-button", has_text="Open Controls").last.click()


def press(page, button):
    page.locator("li.cr.function", has_text=button).first.click()


def set_slider(page, name, value):
    field = page.locator("li.cr.number", has_text=name).locator("input")
    field.fill(str(value))
    field.press("Enter")


VECTOR = "new MeshCat.THREE.Vector3()"
TARGET = "viewer.scene_tree.find(['target']).object"


def node(*path):
    """JavaScript: an object of the drawn arm."""
    return f"viewer.scene_tree.find({['drake', *path]!r}).object"


def hand(page):
    """Where the page shows the hand, in the world of the arm, (3,), m."""
    return np.array(page.evaluate(f"{node('visualizer', 'arm14', 'hand')}.matrix.elements")[12:15])


def settle(live, page):
    """Waits until the page shows the arm where the simulation has brought it to rest. Returns where its hand is."""
    plant = MakeTorqueArm(load_arm())
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, live.arm_state[:2])
    expected = plant.GetBodyByName("hand").EvalPoseInWorld(context).translation()
    until_true(lambda: np.allclose(hand(page), expected, atol=2e-3), lambda: page.wait_for_timeout(50))
    return expected


def in_panel(text):
    """JavaScript: whether the page shows a text beside the controls, with whatever line breaks."""
    return f"document.querySelector('.dg.main').innerText.replace(/\\s+/g, ' ').includes({text!r})"


def until_true(condition, step):
    """Simulates until a condition holds."""
    deadline = time.monotonic() + 120.0
    while not condition():
        assert time.monotonic() < deadline
        step()
        time.sleep(0.01)


def to_the_end(live, say):
    """Simulates the rest of the movement."""
    while live.time < live.end:
        live.Step(say)


def test_the_page_of_a_movement_obeys():
    planned = PlannedMovement.of_scenario(load_scenario("reach-045"))
    live = LiveReplay(planned, find_driver(str(POLICIES / "reach-045" / "policy.safetensors")))
    said = []

    def step():
        live.Step(said.append)

    with visit(live.meshcat.web_url()) as visited:
        page = visited.page
        open_controls(page)
        set_slider(page, SPEED, 100)
        until(page, in_panel("driven by: policy reach-045"), step)
        to_the_end(live, said.append)
        end, at_end = live.arm_state, settle(live, page)

        press(page, PLAY)  # the same movement again
        until_true(lambda: live.time < live.end, step)
        until_true(lambda: np.linalg.norm(hand(page) - at_end) > 0.02, lambda: page.wait_for_timeout(50))
        to_the_end(live, said.append)
        np.testing.assert_array_equal(live.arm_state, end)

        set_slider(page, LOAD, 1.5)  # is drawn and planned, and the policy for many movements carries it
        until(page, in_panel("driven by: policy reaching"), step)
        until(page, f"{node('visualizer', 'arm14', 'load')}.children.length > 0", step)
        to_the_end(live, said.append)
        np.testing.assert_allclose(live.arm_state[:2], end[:2], atol=0.03)
        visited.picture("live-replay-desktop")

        set_slider(page, X, 0.3)
        set_slider(page, Y, 0.5)
        press(page, PLAY)
        until_true(lambda: live.time < live.end, step)
        to_the_end(live, said.append)
        settle(live, page)
        np.testing.assert_allclose(page.evaluate(f"{TARGET}.matrix.elements")[12:15:2], (0.3, 0.5), atol=1e-3)
        assert said == []

        set_slider(page, X, 0.65)
        until(page, in_panel("The hand cannot reach"), step)
        assert "The hand cannot reach x = 0.65 m" in said[-1]
        page.set_viewport_size({"width": 400, "height": 800})
        visited.picture("live-replay-phone")
        press(page, STOP)
        live.Run(said.append)  # ends
        assert visited.errors == []


def test_the_live_arm_obeys_a_persons_clicks():
    policy, repertoire = policy_and_repertoire(None)
    live, said = Live(repertoire, policy), []

    def step():
        live.Step(said.append)

    with visit(live.meshcat.web_url()) as visited:
        page = visited.page
        open_controls(page)
        page.wait_for_function("viewer.scene_tree.find(['drake', 'muscles']).object.children.length > 0")
        step()
        before = settle(live, page)
        set_slider(page, "load", 0.5)
        until(page, "viewer.scene_tree.find(['load']).object.children.length > 0", step)
        set_slider(page, "target x", 0.3)
        set_slider(page, "target y", 0.5)
        set_slider(page, "time", 0.8)
        press(page, REACH)
        began = live.context.get_time()
        until_true(lambda: np.abs(live.arm_state[2:]).max() > 0.5, step)
        until_true(lambda: live.context.get_time() > began + 1.5, step)
        assert np.linalg.norm(settle(live, page) - before) > 0.05
        palm = page.evaluate(f"{node('visualizer', 'arm14', 'hand')}.getWorldPosition({VECTOR}).toArray()")
        load = page.evaluate(f"viewer.scene_tree.find(['load']).object.getWorldPosition({VECTOR}).toArray()")
        assert np.linalg.norm(np.subtract(palm, load)) < 0.1  # the load is in the hand
        visited.picture("live-desktop")

        set_slider(page, "target x", -0.3)
        set_slider(page, "target y", 1.2)
        press(page, REACH)
        until_true(lambda: said, step)
        until(page, in_panel(said[0]), step)
        page.set_viewport_size({"width": 400, "height": 800})
        visited.picture("live-phone")
        press(page, STOP)
        live.Run(said.append)  # ends
        assert visited.errors == []


class Late(LivePage):
    """Takes too long for two frames, and ends with the third one."""

    frames = 0

    def Step(self, say=print):
        time.sleep(5.0 * FRAME)
        self.frames += 1
        return self.frames < 3


def test_a_page_that_is_late_says_so():
    live = Late({}, ())
    with visit(live.meshcat.web_url()) as visited:
        open_controls(visited.page)
        live.Run(print)
        assert live.lag > 4.0 * FRAME
        field = visited.page.locator("li.cr.number", has_text=LAG).locator("input")
        until_true(lambda: field.input_value() == str(round(1000.0 * live.lag)), lambda: None)
