"""Remakes the pictures of the README from shipped policies: `python docs/make_pictures.py`, or `make pictures`.

It needs Playwright and Chromium. `--quick` writes one small picture into a temporary folder and only shows that it
works.
"""

import argparse
import tempfile
from pathlib import Path

from drakearm.experiments import RunFolder, adopt_step, evaluate_step, replay_step, shipped_run
from drakearm.model import Recording
from drakearm.replay.film import write_film, write_picture

DOCS = Path(__file__).parent
FILM = "lift-2kg"  # the first picture of the README
PICTURE = "obstacle"


def make_page(scenario: str, folder: Path) -> tuple[Path, float]:
    """The replay of a shipped policy in a folder, and the duration of its movement, s."""
    run, shipped = RunFolder(folder / scenario), shipped_run(scenario)
    assert shipped is not None
    adopt_step(run, scenario, shipped)
    evaluate_step(run)
    return replay_step(run), float(Recording.load(run.path("recording")).t[-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one small picture in a temporary folder")
    quick = parser.parse_args().quick
    with tempfile.TemporaryDirectory() as folder:
        page, duration = make_page(FILM, Path(folder))
        if quick:
            files = [Path(folder, "quick.png")]
            write_picture(page, files[0], 0.5 * duration, (320, 200))
        else:
            files = [DOCS / "replay.gif", DOCS / "replay.png"]
            write_film(page, files[0], duration, size=(960, 540))
            page, duration = make_page(PICTURE, Path(folder))
            write_picture(page, files[1], 0.55 * duration)
        print("| file | size (kB) |")
        print("|---|---|")
        for file in files:
            print(f"| {file.name} | {file.stat().st_size // 1000} |")


if __name__ == "__main__":
    main()
