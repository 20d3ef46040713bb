"""The content of a replay's page, and how a browser shows it."""

import html
import re
import struct
from base64 import b64decode
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Meshcat, MeshcatParams

from drakearm.diagrams import MakePolicyLoop, MakeStaticLoop
from drakearm.errors import StorageError
from drakearm.experiments.scenario import load_scenario
from drakearm.model import Arm, load_arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.recording import Recording
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.replay import Caption, write_replay
from drakearm.replay.page import make_page
from tests.full_disk import full_disk
from tests.recordings import still_recording

SAMPLES = 21


@pytest.fixture(scope="module")
def arm() -> Arm:
    return load_arm()


@pytest.fixture(scope="module")
def recording(arm: Arm) -> Recording:
    n = len(arm.muscles)
    share = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    q = np.hstack([0.4 * share, 0.3 + 1.4 * share])
    v = np.gradient(q, CONTROL_STEP, axis=0)
    still = still_recording(SAMPLES, 2, n)
    return replace(still, q=q, v=v, reference_q=q + 0.2, reference_v=v, activation=np.repeat(share, n, axis=1))


@pytest.fixture(scope="module")
def page(arm: Arm, recording: Recording, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("replay") / "replay.html"
    write_replay(
        file, arm, recording, load_mass=2.0, caption=Caption("Lift <2 kg>", ["by hand"], "failed", failed=True)
    )
    return file


def test_the_obstacle_is_fixed_in_the_world_and_has_no_ghost(arm: Arm, recording: Recording, tmp_path: Path) -> None:
    obstacle = Obstacle(position=(0.33, 0.25, 0.17), radius=0.03, length=0.25)
    write_replay(tmp_path / "replay.html", arm, recording, obstacle=obstacle)
    shapes = [c for c in _commands(tmp_path / "replay.html") if b"CylinderGeometry" in c and b"/arm/world/" in c]
    bars = [c for c in shapes if struct.pack(">d", 0.03) in c and struct.pack(">d", 0.25) in c]
    assert len(bars) == 1
    assert not [c for c in _commands(tmp_path / "replay.html") if b"/reference/world" in c]


@pytest.mark.parametrize(
    "make",
    [lambda task, meshcat: MakePolicyLoop(task, lambda _: np.zeros(14), meshcat), MakeStaticLoop],
    ids=["policy", "static"],
)
def test_a_live_drawing_of_a_loop_shows_the_obstacle(make: Callable, reference: Reference) -> None:
    params = MeshcatParams()
    params.host, params.port = "localhost", 0
    meshcat = Meshcat(params)
    diagram = make(load_scenario("obstacle").task(reference), meshcat=meshcat).diagram
    diagram.ForcedPublish(diagram.CreateDefaultContext())
    assert meshcat.HasPath("/drake/visualizer/obstacle")


def _commands(page: Path) -> list[bytes]:
    """The commands to Meshcat in a page, in msgpack format."""
    codes = re.findall(r'fetch\("data:[^,"]*,([^"]*)"', page.read_text())
    return [b64decode(code) for code in codes]


def test_every_piece_of_every_muscle_moves_in_every_frame(page: Path, arm: Arm) -> None:
    (animation,) = [c for c in _commands(page) if b"set_animation" in c]
    clips = animation.split(b"\xa4path")[1:]
    frames = SAMPLES // 2 + 2  # every second sample; the last frame ends the pause before the next repetition
    for muscle in arm.muscles:
        for k in range(11):
            piece = f"/drakearm/muscles/{muscle.name}/{k}"
            pose, stretch = (_of(clips, name) for name in (piece, f"{piece}/shape"))
            assert pose.count(b"\xa4time") == 2 * frames  # position and quaternion
            assert stretch.count(b"\xa4time") == frames
            if 2 <= k < 9:  # the belly
                color = _of(clips, f"{piece}/shape/surface/<object>")
                assert color.count(b"\xa4time") == 3 * frames  # red, green, blue
    for body in ("arm/hand", "reference/hand", "arm/load"):
        assert _of(clips, f"/drakearm/{body}").count(b"\xa4time") == 2 * frames
    assert not [clip for clip in clips if clip.split(b"\xa4clip")[0].endswith(b"/reference/load")]


def _of(clips: list[bytes], path: str) -> bytes:
    """The animation clip of the object at a path."""
    (clip,) = [clip for clip in clips if clip.split(b"\xa4clip")[0].endswith(path.encode())]
    return clip


def test_page_loads_no_other_files(page: Path) -> None:
    text = page.read_text()
    assert not re.findall(r"<(?:script|link|img|iframe)[^>]*(?:src|href)\s*=", text)
    assert not re.findall(r"""(?:fetch|import|WebSocket)\(\s*["'](?:https?|wss?):""", text)
    assert not re.findall(r"@import|url\(\s*[\"']?https?:", text)


def test_the_browser_refuses_every_request_to_another_place(page: Path) -> None:
    """The first element of the page that could load anything is the policy that forbids it."""
    policy = "default-src 'unsafe-inline' 'unsafe-eval' data: blob:"
    text = page.read_text()
    assert re.search(r"<[a-z][^>]*>", text[text.index("<head>") + 6 :])[0] == (
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
    )


def test_the_title_is_escaped(page: Path) -> None:
    text = page.read_text()
    assert "<title>Lift &lt;2 kg&gt;</title>" in text
    assert "<h1>Lift &lt;2 kg&gt;</h1>" in text


@pytest.mark.parametrize(
    "title", ["</title><script>alert(1)</script>", '"\' onload="alert(1)', "</head>", "$path ${x} $"]
)
def test_no_title_can_add_to_the_page(title: str, arm: Arm, recording: Recording) -> None:
    def page(text: str) -> str:
        frame = "<html><head><title>Drake MeshCat</title></head><body></body></html>"
        return make_page(frame, Caption(text, [text], text), 0.25, recording, arm, {})

    plain = page("plain")
    assert page(title).replace(html.escape(title), "plain") == plain
    assert page(title).count("<script") == plain.count("<script") == 3 and plain.count("</head>") == 1


def test_a_full_disk_leaves_the_earlier_page(arm: Arm, recording: Recording, tmp_path: Path) -> None:
    file = tmp_path / "replay.html"
    file.write_text("an earlier page")
    with full_disk(), pytest.raises(StorageError, match=r"replay.html cannot be written: File too large"):
        write_replay(file, arm, recording)
    assert file.read_text() == "an earlier page"
    assert list(tmp_path.iterdir()) == [file]
