"""`move` and `live`: the hand gets to where it is asked to be, and what is impossible is refused before it moves."""

import numpy as np
import pytest

from drakearm.errors import PlanningError
from drakearm.model import Recording
from drakearm.repertoire.live import DISTURB, FRAME, REACH, SLIDERS, STOP, Live
from drakearm.repertoire.move import move
from drakearm.repertoire.shipped import policy_and_repertoire


@pytest.fixture(scope="module")
def learned():
    policy, repertoire = policy_and_repertoire(None)
    return repertoire, policy


def test_the_hand_gets_there(learned, tmp_path):
    made = move(*learned, (0.3, 0.5), duration=0.7, load_mass=0.5)
    np.testing.assert_allclose(made.recording.p_WH[-1, :2], (0.3, 0.5), atol=0.01)
    files = made.save(tmp_path)
    assert sorted(files) == sorted(tmp_path.iterdir())
    np.testing.assert_array_equal(Recording.load(tmp_path / "recording.npz").q, made.recording.q)


def test_it_keeps_clear_of_a_bar(learned):
    made = move(*learned, (0.45, 0.62), avoid=(0.36, 0.45, 0.03), duration=0.8)
    assert made.metrics["clearance_cm"] > 0.0


@pytest.mark.parametrize(
    ("to", "options", "sentence"),
    [
        ((0.9, 0.6), {}, "cannot reach"),
        ((0.45, 0.8), {"load_mass": 8.0}, "The muscles cannot do it.*smaller load"),
        ((0.45, 0.8), {"duration": 0.1}, "There is no plan|The muscles cannot do it"),
        ((0.4, 0.6), {"start_deg": (0.0, 80.0, 1.0)}, "expected 2, for shoulder, elbow"),
        ((0.4, 0.6), {"start_deg": (-20.0, 150.0)}, "within its joint limits"),
    ],
)
def test_the_impossible_is_refused(learned, to, options, sentence):
    with pytest.raises(PlanningError, match=sentence):
        move(*learned, to, **options)


def click(live, button):
    """What the page sends when a button is pressed: {"type": "button", "name": ...} as MessagePack."""
    texts = b"".join(bytes([0xA0 | len(text)]) + text.encode() for text in ("type", "button", "name", button))
    live.meshcat._InjectWebsocketMessage(message=bytes([0x82]) + texts)


def test_the_live_arm_obeys_its_page(learned):
    live, refused = Live(*learned), []
    assert "localhost" in live.meshcat.web_url()
    assert live.Step(refused.append)
    before = live.arm_state[:2]
    click(live, REACH)
    for _ in range(round(0.9 / FRAME)):
        live.Step(refused.append)
    reached = live.arm_state[:2]
    assert np.abs(reached - before).max() > 0.05 and not refused
    click(live, DISTURB)
    strayed = []
    for _ in range(round(0.9 / FRAME)):
        live.Step(refused.append)
        strayed.append(np.abs(live.arm_state[:2] - reached).max())
    assert max(strayed) > 2.0 * strayed[-1]
    live.meshcat.SetSliderValue(next(iter(SLIDERS)), -0.3)
    live.meshcat.SetSliderValue("target y (m)", 1.2)
    click(live, REACH)
    live.Step(refused.append)
    assert len(refused) == 1
    click(live, STOP)
    live.Run(refused.append)
    assert live.lag >= 0.0
