"""Pictures and films of a replay: what is in the files, and one sentence where a program is missing."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from drakearm.errors import FilmError
from drakearm.model import load_arm
from drakearm.model.reference import CONTROL_STEP
from drakearm.replay import Caption, write_replay
from drakearm.replay.film import RATE, write_film, write_picture
from tests.browser import needs_chromium
from tests.recordings import still_recording

SAMPLES = 11


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    file = tmp_path_factory.mktemp("film") / "replay.html"
    share = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    q = np.hstack([0.4 * share, 0.3 + 1.4 * share])
    recording = replace(still_recording(SAMPLES, 2, 14), q=q, reference_q=q, activation=np.repeat(share, 14, axis=1))
    write_replay(file, load_arm(), recording, caption=Caption("bend"))
    return file


@pytest.mark.slow
@pytest.mark.extra
@needs_chromium
def test_a_picture_and_a_film_show_the_movement(page, tmp_path):
    for name, at in (("start.png", 0.0), ("end.png", 0.1)):
        write_picture(page, tmp_path / name, at, (480, 300))
    start, end = (
        np.asarray(Image.open(tmp_path / name).convert("RGB")).astype(int) for name in ("start.png", "end.png")
    )
    assert start.shape == (300, 480, 3) and np.abs(end - start).max() > 100
    write_film(page, tmp_path / "film.gif", (SAMPLES - 1) * CONTROL_STEP, size=(480, 300))
    film = Image.open(tmp_path / "film.gif")
    assert film.size == (480, 300) and film.n_frames >= 0.1 / 0.25 * RATE  # equal frames at the end may be one
    if shutil.which("ffmpeg"):
        write_film(page, tmp_path / "film.mp4", (SAMPLES - 1) * CONTROL_STEP, size=(480, 300))
        assert b"ftyp" in (tmp_path / "film.mp4").read_bytes()[:16]


def test_what_is_missing_is_said(page, tmp_path, monkeypatch):
    with pytest.raises(FilmError, match=r"ending .avi: expected .gif or .mp4"):
        write_film(page, tmp_path / "film.avi", 0.1)
    monkeypatch.setattr("shutil.which", lambda program: None)
    with pytest.raises(FilmError, match="ffmpeg is not installed"):
        write_film(page, tmp_path / "film.mp4", 0.1)
    with pytest.raises(FilmError, match="Chromium is not installed"):
        write_picture(page, tmp_path / "picture.png", 0.0)
    monkeypatch.setitem(__import__("sys").modules, "playwright.sync_api", None)
    with pytest.raises(FilmError, match=r"expected `pip install drakearm\[films\]`"):
        write_picture(page, tmp_path / "picture.png", 0.0)
    assert list(tmp_path.iterdir()) == []
