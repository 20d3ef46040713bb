"""Writes the replay of a recorded movement: one HTML file that needs no other files."""

from pathlib import Path

import numpy as np
from pydrake.geometry import MeshcatAnimation

from drakearm.files import replacement
from drakearm.model import Arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.recording import Recording
from drakearm.model.reference import CONTROL_STEP
from drakearm.replay.page import make_page
from drakearm.replay.scene import ReplayScene

PLAYBACK_SPEED = 0.25  # movements last less than a second
_PAUSE = 0.15  # s of movement time, between the end of one repetition and the start of the next
_REPETITIONS = 1_000_000  # in practice it repeats indefinitely


def write_replay(
    file: Path,
    arm: Arm,
    recording: Recording,
    *,
    load_mass: float = 0.0,
    obstacle: Obstacle | None = None,
    title: str = "drakearm replay",
) -> None:
    """Writes a web page that repeats the recorded movement in slow motion.

    It shows the arm with muscles colored by activation, the reference posture as a ghost, and the path of the hand's
    tip. It also shows the load (load_mass, kg) and the obstacle, if there are any. Append #t=0.3 to the page's address
    to pause the replay at 0.3 s. Raises StorageError if the file cannot be written, and leaves an earlier one then.
    """
    scene = ReplayScene(arm, load_mass, obstacle)
    scene.draw_tip_path(recording.q)
    scene.frame_camera(np.vstack([recording.q, recording.reference_q]))
    scene.draw(recording, 0)
    frames_per_second = PLAYBACK_SPEED / CONTROL_STEP
    meshcat = scene.meshcat
    meshcat.StartRecording(frames_per_second, set_visualizations_while_recording=False)
    last = len(recording.t) - 1
    pause = round(_PAUSE / CONTROL_STEP)
    for frame, i in [*((i, i) for i in range(last + 1)), (last + pause, last)]:
        scene.draw(recording, i, (frame + 0.5) / frames_per_second)  # half a frame more, because Meshcat rounds down
    meshcat.StopRecording()
    animation = meshcat.get_mutable_recording()
    animation.set_loop_mode(MeshcatAnimation.LoopMode.kLoopRepeat)
    animation.set_repetitions(_REPETITIONS)
    meshcat.PublishRecording()
    page = make_page(meshcat.StaticHtml(), title, PLAYBACK_SPEED, recording.t[-1] - recording.t[0])
    with replacement(Path(file)) as partial:
        partial.write_text(page, encoding="utf-8")
