"""Pictures and films of a replay's page, for papers and talks, made by a browser without a display.

They need Playwright (`pip install drakearm[films]`) and Chromium, and for .mp4 also ffmpeg.
"""

import io
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from drakearm.errors import FilmError, shown
from drakearm.files import replacement
from drakearm.files.writing import storage

SIZE, WIDE = (960, 600), (1280, 720)  # pixels, of one scene and of two
RATE = 25  # frames per second
# Software rendering, which needs no graphics card and no display.
BROWSER_OPTIONS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
_PAUSE = 0.6  # s, of the last frame
_COLORS = 256  # of a GIF: more make the file larger
_HIDE = (
    "#replay-controls { display: none !important; } #replay-legend { bottom: 18px; } #replay-strip { bottom: 18px; }"
)


def find_chromium() -> str | None:
    """The program that shows pages; None if it is not installed."""
    return shutil.which("chromium") or shutil.which("google-chrome")


def write_picture(page: Path, file: Path, at: float, size: tuple[int, int] = SIZE) -> None:
    """Writes a .png of a replay's page at a time (s) of the movement. Raises FilmError if a program is missing."""
    (frame,) = _frames(page, [at], size)
    with replacement(file) as partial:
        partial.write_bytes(frame)


def write_film(page: Path, file: Path, duration: float, speed: float = 0.25, size: tuple[int, int] = SIZE) -> None:
    """Writes a .gif or .mp4 of a replay's page. duration: s, of the movement. speed: as a fraction of real time.

    Raises FilmError if a program is missing, or if the file has another ending.
    """
    if file.suffix not in (".gif", ".mp4"):
        raise FilmError(f"{shown(file)} has the ending {file.suffix or 'none'}: expected .gif or .mp4.")
    if file.suffix == ".mp4" and not shutil.which("ffmpeg"):
        raise FilmError("ffmpeg is not installed: expected its program in the PATH, to write an .mp4.")
    count = max(2, round(duration / speed * RATE))
    frames = _frames(page, [duration * k / (count - 1) for k in range(count)], size)
    frames += frames[-1:] * round(_PAUSE * RATE)
    with replacement(file) as partial:
        _write_gif(partial, frames) if file.suffix == ".gif" else _write_mp4(partial, frames)


def _frames(page: Path, times: list[float], size: tuple[int, int]) -> list[bytes]:
    """A .png of the page at each time, s.

    In a thread of its own, because Playwright refuses one in which something asynchronous runs, such as a notebook.
    """
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(lambda: list(_frames_here(page, times, size))).result()


def _frames_here(page: Path, times: list[float], size: tuple[int, int]) -> Iterator[bytes]:
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError as error:
        raise FilmError("Playwright is not installed: expected `pip install drakearm[films]`.") from error
    chromium = find_chromium()
    if chromium is None:
        raise FilmError("Chromium is not installed: expected its program chromium in the PATH.")
    with sync_playwright() as playwright:
        try:
            browser = playwright.chromium.launch(executable_path=chromium, args=BROWSER_OPTIONS)
            tab: Any = browser.new_page(viewport={"width": size[0], "height": size[1]}, color_scheme="light")
            tab.goto(page.resolve().as_uri())
            tab.wait_for_function("document.body.dataset.replay === 'ready'")
            tab.add_style_tag(content=_HIDE)
            for time in times:
                tab.evaluate("time => { location.hash = `t=${time}` }", time)
                tab.wait_for_function("time => Math.abs(Number(replay_time()) - time) < 1e-4", arg=time)
                # Two frames: the first one draws the scene, the second one shows it.
                tab.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
                yield tab.screenshot(type="png")
            browser.close()
        except Error as error:
            raise FilmError(f"Chromium cannot show {shown(page)}: {error}") from error


def _write_gif(file: Path, frames: list[bytes]) -> None:
    from PIL import Image

    pictures = [Image.open(io.BytesIO(frame)).convert("RGB") for frame in frames]
    # One palette for all frames, so that a color does not flicker; from few large areas, rare colors would be missing.
    width, height = pictures[0].size
    chosen = pictures[:: max(1, len(pictures) // 6)]
    together = Image.new("RGB", (width, height * len(chosen)))
    for k, picture in enumerate(chosen):
        together.paste(picture, (0, height * k))
    palette = together.quantize(_COLORS, method=Image.Quantize.FASTOCTREE)
    first, *others = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    first.save(file, format="GIF", save_all=True, append_images=others, duration=1000 // RATE, loop=0, optimize=True)


def _write_mp4(file: Path, frames: list[bytes]) -> None:
    with tempfile.TemporaryDirectory() as folder, storage(file, "cannot be written"):
        for k, frame in enumerate(frames):
            Path(folder, f"{k:05d}.png").write_bytes(frame)
        command = ["ffmpeg", "-y", "-loglevel", "error", "-framerate", str(RATE), "-i", f"{folder}/%05d.png"]
        done = subprocess.run([*command, "-pix_fmt", "yuv420p", "-f", "mp4", str(file)], capture_output=True, text=True)
        if done.returncode:
            raise FilmError(f"ffmpeg cannot write the film: {done.stderr.strip()}")
