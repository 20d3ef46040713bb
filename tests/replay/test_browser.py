"""What a browser makes of a replay: it loads alone, moves as recorded, and obeys its keys and buttons."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant

from drakearm.model import load_arm
from drakearm.model.reference import CONTROL_STEP
from drakearm.model.skeleton import add_skeleton
from drakearm.replay import Caption, write_replay
from drakearm.systems.muscle_drawing import activation_color, upright
from tests.browser import needs_chromium, visit
from tests.recordings import still_recording

SAMPLES = 41
pytestmark = [pytest.mark.slow, pytest.mark.extra, needs_chromium]


@pytest.fixture(scope="module")
def arm():
    return load_arm()


@pytest.fixture(scope="module")
def recording(arm):
    share = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    q = np.hstack([0.4 * share, 0.3 + 1.4 * share])
    v = np.gradient(q, CONTROL_STEP, axis=0)
    activation = np.clip(share * np.linspace(0.2, 1.0, len(arm.muscles)), 0.0, 1.0)
    still = still_recording(SAMPLES, 2, len(arm.muscles))
    return replace(still, q=q, v=v, reference_q=q + 0.1, reference_v=v, activation=activation)


@pytest.fixture(scope="module")
def address(arm, recording, tmp_path_factory):
    file = tmp_path_factory.mktemp("replay") / "replay.html"
    caption = Caption("lift", ["a test"], "The muscles cannot do it.", failed=True)
    write_replay(file, arm, recording, load_mass=2.0, caption=caption)
    return file.as_uri()


@pytest.fixture(scope="module")
def opened(address):
    with visit(address) as visited:
        visited.page.wait_for_function("document.body.dataset.replay === 'ready'")
        yield visited


def time_of(page):
    return page.evaluate("viewer.animator.time") * 0.25  # the animation was recorded at 25 % of real time


def seek(page, seconds):
    page.evaluate("address => { location.hash = address }", f"t={seconds}")
    page.wait_for_function(f"Math.abs(viewer.animator.time * 0.25 - {seconds}) < 1e-6")


def hand_position(arm, q):
    """In Meshcat's world, m."""
    plant = MultibodyPlant(0.0)
    add_skeleton(plant, arm)
    plant.Finalize()
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    return (upright(arm) @ plant.GetBodyByName("hand").EvalPoseInWorld(context)).translation()


def test_it_loads_alone_and_without_an_error(opened, address):
    assert opened.errors == []
    assert {url for url in opened.requests if not url.startswith(("data:", "blob:"))} == {address}
    assert opened.page.inner_text("#replay-caption .bad") == "The muscles cannot do it."
    assert opened.picture("replay-desktop").stat().st_size > 30_000  # not empty
    assert opened.page.evaluate("viewer.renderer.domElement.width") % 1280 == 0


@pytest.mark.parametrize("sample", [0, 17, 40])
def test_the_arm_and_its_muscles_are_as_recorded(opened, arm, recording, sample):
    seek(opened.page, sample * CONTROL_STEP)
    matrix = opened.page.evaluate("""() => {
        viewer.render();
        return viewer.scene_tree.find(["drakearm", "arm", "hand"]).object.matrixWorld.elements;
    }""")
    x, y, z = hand_position(arm, recording.q[sample])  # in three.js, y points up
    np.testing.assert_allclose(matrix[12:15], [x, z, -y], atol=2e-3)
    muscle = arm.muscles[-1].name
    found = opened.page.evaluate(
        """name => {
            const colors = [];
            viewer.scene_tree.find(["drakearm", "muscles", name]).object.traverse(shape => {
                if (shape.isMesh) colors.push(shape.material.color.clone().convertLinearToSRGB().toArray());
            });
            return colors;
        }""",
        muscle,
    )
    expected = activation_color(recording.activation[sample, -1])
    assert min(np.abs(np.array(found) - expected).max(axis=1)) < 0.02


def test_the_ghost_is_the_moving_bodies_at_the_reference(opened, arm, recording):
    seek(opened.page, 0.2)
    names, hand, far_side = opened.page.evaluate("""() => {
        viewer.render();
        const ghost = viewer.scene_tree.find(["drakearm", "reference"]), materials = [];
        ghost.object.traverse(shape => { if (shape.isMesh) materials.push(shape.material); });
        return [Object.keys(ghost.children), ghost.find(["hand"]).object.matrixWorld.elements,
            materials.every(material => material.side === MeshCat.THREE.BackSide && !material.depthWrite)];
    }""")
    assert {"r_humerus", "ulna", "hand"} <= set(names) and not {"base", "load"} & set(names)
    assert far_side
    x, y, z = hand_position(arm, recording.reference_q[20])
    np.testing.assert_allclose(hand[12:15], [x, z, -y], atol=2e-3)


def test_muscles_are_one_mesh_around_the_pieces_that_move(opened, arm):
    """Also that few draw calls make a picture: each takes time where no graphics card helps."""
    seek(opened.page, 0.2)
    merged, pieces, calls = opened.page.evaluate("""() => {
        viewer.render();
        const { Box3 } = MeshCat.THREE, box = new Box3();
        const at = viewer.scene.getObjectByName("all muscles").geometry.attributes.position;
        const pieces = viewer.scene_tree.find(["drakearm", "muscles"]).object;
        const corners = box => [...box.min.toArray(), ...box.max.toArray()];
        return [corners(box.setFromBufferAttribute(at)), corners(new Box3().setFromObject(pieces, true)),
            viewer.renderer.info.render.calls];
    }""")
    np.testing.assert_allclose(merged, pieces, atol=6e-3)
    assert calls < 40 < 11 * len(arm.muscles)


def test_pixels_are_finer_while_the_arm_stands_still(opened):
    """So that edges are smooth in pictures and films, and that the arm moves smoothly without a graphics card."""
    page = opened.page
    seek(page, 0.15)
    assert page.evaluate("viewer.renderer.getPixelRatio()") == 2
    page.keyboard.press("Space")
    assert page.evaluate("viewer.renderer.getPixelRatio()") == 1
    page.keyboard.press("Space")


def test_keys_and_buttons(opened):
    page = opened.page
    seek(page, 0.1)
    page.keyboard.press("ArrowRight")
    assert time_of(page) == pytest.approx(0.11)
    page.keyboard.press("ArrowLeft")
    assert time_of(page) == pytest.approx(0.10)
    page.keyboard.press("Space")
    assert page.inner_text("#replay-play") == "Pause"
    page.wait_for_function("Math.abs(viewer.animator.time * 0.25 - 0.1) > 0.005")
    page.click("#replay-play")
    assert page.inner_text("#replay-play") == "Play"
    seek(page, 0.38)
    page.click("#replay-loop")
    page.keyboard.press("Space")
    page.wait_for_function("document.getElementById('replay-play').textContent === 'Play'")
    assert time_of(page) == pytest.approx(0.4)
    page.click("#replay-loop")


def test_the_speed_is_that_of_the_clock(opened):
    """From frame to frame, the time of the movement passes as slowly as chosen."""
    page = opened.page
    page.select_option("select[aria-label=speed]", "0.1")
    seek(page, 0.0)
    page.keyboard.press("Space")
    passed, of_clock = page.evaluate("""() => new Promise(done => {
        let frames = 0, first, began;
        const look = now => {
            if (frames++ === 0) [first, began] = [replay_time(), now];
            if (frames > 3) done([replay_time() - first, (now - began) / 1000]);
            else requestAnimationFrame(look);
        };
        requestAnimationFrame(look);
    })""")
    assert passed / of_clock == pytest.approx(0.1, rel=1e-3)
    page.keyboard.press("Space")
    page.select_option("select[aria-label=speed]", "0.25")


def test_the_side_view_is_along_the_elbows_axis(opened):
    page = opened.page
    page.click("[data-view=side]")
    look = page.evaluate("viewer.controls.target.clone().sub(viewer.camera.position).normalize().toArray()")
    assert abs(look[2]) > 0.99  # the axis of the elbow is nearly z of the world, which stands upright in Meshcat
    assert page.get_attribute("[data-view=side]", "aria-pressed") == "true"
    opened.picture("replay-side")
    page.click("[data-view=oblique]")


def test_the_pointer_names_a_muscle(opened, arm):
    page = opened.page
    seek(page, 0.4)
    place = page.evaluate(
        """name => {
            viewer.render();
            const sum = new MeshCat.THREE.Box3().setFromObject(
                viewer.scene_tree.find(["drakearm", "muscles", name]).object).getCenter(new MeshCat.THREE.Vector3());
            const at = sum.project(viewer.camera), box = viewer.renderer.domElement.getBoundingClientRect();
            return [box.left + box.width * (at.x + 1) / 2, box.top + box.height * (1 - at.y) / 2];
        }""",
        "BIClong",
    )
    names = {muscle.name for muscle in arm.muscles}
    found = set()
    for dx in range(-30, 31, 3):
        page.mouse.move(place[0] + dx, place[1])
        if page.is_visible("#replay-pointer"):
            found.add(page.inner_text("#replay-pointer").split(":")[0])
    assert found and found <= names


def test_a_phone_and_a_dark_room(address):
    with visit(address, 390, 780, color_scheme="dark") as visited:
        visited.page.wait_for_function("document.body.dataset.replay === 'ready'")
        picture = visited.picture("replay-phone-dark")
        assert picture.stat().st_size > 10_000
        assert not visited.page.is_visible("#replay-strip")
        corners = visited.page.evaluate("""() => {
            const points = [];
            viewer.scene_tree.find(["drakearm", "arm"]).object.traverse(shape => {
                if (shape.isMesh) points.push(shape.getWorldPosition(new MeshCat.THREE.Vector3())
                    .project(viewer.camera).toArray());
            });
            return points;
        }""")
        assert np.abs(np.array(corners)[:, :2]).max() < 1.0  # all bodies are in the picture
