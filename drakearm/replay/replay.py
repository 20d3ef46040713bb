"""Writes replays of recorded movements, alone or side by side: one HTML file that needs no other files."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from pydrake.geometry import MeshcatAnimation

from drakearm.files import replacement
from drakearm.model import Arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.recording import Recording
from drakearm.model.reference import CONTROL_STEP
from drakearm.replay.comparison import make_comparison
from drakearm.replay.movement import Caption, RecordedMovement, duration
from drakearm.replay.page import make_page
from drakearm.replay.scene import ReplayScene

PLAYBACK_SPEED = 0.25  # movements last less than a second
_EVERY = 2  # samples: the browser interpolates between these, so that the page is not too large
_PAUSE = 0.15  # s of movement time, between the end of one repetition and the start of the next
_REPETITIONS = 1_000_000  # in practice it repeats indefinitely


def write_replay(
    file: Path,
    arm: Arm,
    recording: Recording,
    *,
    load_mass: float = 0.0,
    obstacle: Obstacle | None = None,
    caption: Caption | None = None,
) -> None:
    """Writes a web page that repeats the recorded movement in slow motion.

    It shows the arm with muscles colored by activation, the reference posture as a ghost, the path of the hand, its
    target, and a strip of angles and activations. It also shows the load (load_mass, kg) and the obstacle, if there
    are any. caption: what moves and how well.

    The space bar plays and pauses, the arrow keys move by 10 ms, and #t=0.3 at the end of the page's address pauses
    the replay at 0.3 s. Raises RunFolderError if the recording is not of this arm, StorageError if the file cannot be
    written. An earlier file is left then.
    """
    shown = RecordedMovement(arm, recording, load_mass, obstacle, caption or Caption("drakearm replay"))
    _write(file, _page(shown, [shown], alone=True))


def write_comparison(file: Path, left: RecordedMovement, right: RecordedMovement) -> None:
    """Writes a web page that shows two recorded movements side by side, at the same time and in the same views.

    The longer one determines how long it takes; the other one rests at its end. The page, its keys and the errors are
    those of `write_replay`.
    """
    both = [left, right]
    halves = _page(left, both, alone=False), _page(right, both, alone=False)
    titles = left.caption.title, right.caption.title
    longest = max(duration(each.recording) for each in both)
    _write(file, make_comparison(halves, titles, (left.arm, right.arm), longest))


def _page(shown: RecordedMovement, together: Sequence[RecordedMovement], *, alone: bool) -> str:
    """The page of a movement, or its half of a comparison. together: all movements that the views have to hold."""
    shown.recording.check(shown.arm)
    scene = ReplayScene(shown.arm, shown.load_mass, shown.obstacle)
    alike = [each.recording for each in together if each.arm.coordinates == shown.arm.coordinates]
    views = scene.views(np.vstack([q for each in alike for q in (each.q, each.reference_q)]))
    scene.set_camera(views["oblique"])
    animate(scene, shown.recording)
    return make_page(
        scene.meshcat.StaticHtml(),
        shown.caption,
        PLAYBACK_SPEED,
        shown.recording,
        shown.arm,
        views,
        shown.load_mass,
        together=() if alone else [each.recording for each in together],
    )


def _write(file: Path, page: str) -> None:
    with replacement(Path(file)) as partial:
        partial.write_text(page, encoding="utf-8")


def animate(scene: ReplayScene, recording: Recording) -> None:
    """Draws the path and the target of the hand, and replaces the animation of a scene by that of a recording."""
    scene.draw_tip_path(recording.q)
    scene.draw_target(recording.reference_q[-1])
    scene.draw(recording, 0)
    frames_per_second = PLAYBACK_SPEED / CONTROL_STEP
    meshcat = scene.meshcat
    meshcat.StartRecording(frames_per_second, set_visualizations_while_recording=False)
    last = len(recording.t) - 1
    pause = round(_PAUSE / CONTROL_STEP)
    shown = sorted({*range(0, last, _EVERY), last})
    for frame, i in [*((i, i) for i in shown), (last + pause, last)]:
        scene.draw(recording, i, (frame + 0.5) / frames_per_second)  # half a frame more, because Meshcat rounds down
    meshcat.StopRecording()
    animation = meshcat.get_mutable_recording()
    animation.set_loop_mode(MeshcatAnimation.LoopMode.kLoopRepeat)
    animation.set_repetitions(_REPETITIONS)
    meshcat.PublishRecording()
