"""The live view of a training: it shows the movement of a policy, and takes a small share of the time."""

import numpy as np
import pytest

from drakearm.experiments import scenario_task, shipped_run
from drakearm.experiments.training_view import LARGEST_SHARE, TrainingView
from drakearm.learning import Policy


class Clock:
    """Each look takes 0.1 s, and more passes when `now` is set."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        self.now += 0.1
        return self.now


@pytest.fixture(scope="module")
def view():
    return TrainingView(scenario_task("timing-0.4s"), Clock())


def test_the_page_shows_the_latest_policy_and_then_waits(view):
    policy = Policy.load(shipped_run("timing-0.4s").path("policy"))
    still = view._scene.meshcat.StaticHtml()
    assert view.show(lambda: policy)
    first = view._scene.meshcat.StaticHtml()
    assert "localhost" in view.url and len(first) > len(still) + 100_000
    assert not view.show(lambda: pytest.fail("no policy is needed before the time"))
    view._clock.now += 0.1 / LARGEST_SHARE
    assert view.show(lambda: type("Still", (), {"act": lambda self, observation: np.zeros(14)})())
    assert view._scene.meshcat.StaticHtml() != first
