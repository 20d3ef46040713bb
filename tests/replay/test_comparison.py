"""Two movements side by side: one page that needs nothing else, with one clock."""

import re
from dataclasses import replace

import numpy as np
import pytest

from drakearm.model import load_arm
from drakearm.replay import Caption, RecordedMovement, write_comparison, write_replay
from tests.browser import needs_chromium, visit
from tests.recordings import still_recording

LONG, SHORT = 41, 21  # samples


def movement(samples, title, load_mass=0.0):
    share = np.linspace(0.0, 1.0, samples)[:, None]
    q = np.hstack([0.4 * share, 0.3 + 1.4 * share])
    still = still_recording(samples, 2, 14)
    recording = replace(still, q=q, reference_q=q + 0.1, activation=np.repeat(share, 14, axis=1))
    return RecordedMovement(load_arm(), recording, load_mass, caption=Caption(title, ["a test"], "succeeded"))


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    file = tmp_path_factory.mktemp("comparison") / "replay.html"
    write_comparison(file, movement(LONG, "with <1 kg>", 1.0), movement(SHORT, "without a load"))
    return file


def test_meshcat_is_in_the_page_once(page, tmp_path):
    one = movement(LONG, "with <1 kg>", 1.0)
    write_replay(tmp_path / "one.html", one.arm, one.recording, load_mass=1.0, caption=one.caption)
    assert page.stat().st_size < 1.8 * (tmp_path / "one.html").stat().st_size
    assert page.read_text().count("class Animator") == (tmp_path / "one.html").read_text().count("class Animator") == 1


def test_the_browser_refuses_every_request_to_another_place(page):
    text = page.read_text()
    assert re.search(r"<[a-z][^>]*>", text[text.index("<head>") + 6 :])[0].startswith(
        '<meta http-equiv="Content-Security-Policy"'
    )
    assert not re.findall(r"<(?:script|link|img|iframe)[^>]*(?:src|href)\s*=", text)


def test_titles_are_escaped(page):
    assert "<title>with &lt;1 kg&gt; and without a load</title>" in page.read_text()


@pytest.fixture(scope="module")
def opened(page):
    with visit(page.as_uri()) as visited:
        visited.page.wait_for_function("document.body.dataset.replay === 'ready'")
        yield visited


def times(visited):
    """The times that the two scenes show, s."""
    return [frame.evaluate("viewer.animator.time * 0.25") for frame in visited.page.frames[1:]]


def seek(visited, seconds):
    visited.page.evaluate("address => { location.hash = address }", f"t={seconds}")
    visited.page.wait_for_function(f"Math.abs(replay_time() - {seconds}) < 1e-6")


@pytest.mark.slow
@pytest.mark.extra
@needs_chromium
def test_it_loads_alone_and_without_an_error(opened, page):
    assert opened.errors == []
    assert {url for url in opened.requests if not url.startswith(("data:", "blob:"))} <= {page.as_uri(), "about:srcdoc"}
    titles = [frame.inner_text("#replay-caption h1") for frame in opened.page.frames[1:]]
    assert titles == ["with <1 kg>", "without a load"]
    refused = opened.page.evaluate("() => fetch('http://localhost:1').then(() => 'allowed', error => String(error))")
    assert "Failed to fetch" in refused
    refused = opened.page.frames[1].evaluate(
        "() => new Promise(done => { document.onsecuritypolicyviolation = e => done(e.violatedDirective);"
        " fetch('http://localhost:1').catch(() => 0); })"
    )
    assert refused == "connect-src"


@pytest.mark.slow
@pytest.mark.extra
@needs_chromium
def test_both_scenes_have_one_clock(opened):
    seek(opened, 0.15)
    assert times(opened) == pytest.approx([0.15, 0.15])
    seek(opened, 0.3)
    assert times(opened) == pytest.approx([0.3, 0.2])  # the shorter one rests at its end
    opened.page.frames[2].locator("canvas").first.click(position={"x": 20, "y": 300})
    opened.page.keyboard.press("ArrowLeft")  # also when a scene has the focus
    assert times(opened) == pytest.approx([0.29, 0.2])
    opened.page.keyboard.press("Space")
    opened.page.wait_for_function("Math.abs(replay_time() - 0.29) > 0.005")
    opened.page.click("#replay-play")
    first, second = times(opened)
    assert second == pytest.approx(min(first, 0.2))


@pytest.mark.slow
@pytest.mark.extra
@needs_chromium
@pytest.mark.parametrize(("name", "width", "height"), [("desktop", 1280, 800), ("phone", 400, 800)])
def test_both_scenes_have_the_same_size_and_stand_side_by_side(page, name, width, height):
    with visit(f"{page.as_uri()}#t=0.2", width, height) as visited:
        visited.page.wait_for_function("document.body.dataset.replay === 'ready'")
        visited.picture(f"comparison-{name}")
        places = [frame.bounding_box() for frame in visited.page.query_selector_all("iframe")]
        assert places[0]["width"] == places[1]["width"] and places[0]["height"] == places[1]["height"]
        beside = places[1]["x"] >= places[0]["x"] + places[0]["width"]
        assert beside == (name == "desktop")  # one below the other on a phone
        assert places[1]["y"] + places[1]["height"] < height
        for frame in visited.page.frames[1:]:
            assert frame.is_visible("#replay-strip") and frame.is_visible("#replay-caption .good")
        cameras = [frame.evaluate("viewer.camera.position.toArray()") for frame in visited.page.frames[1:]]
        np.testing.assert_allclose(*cameras, rtol=1e-6)
        assert visited.page.evaluate("document.documentElement.scrollWidth") <= width
