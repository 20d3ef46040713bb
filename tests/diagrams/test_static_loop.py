"""The static loop: it follows a movement that the muscles can make, and holds a posture with and without a load."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.diagrams import MakeStaticLoop
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.task import ReferenceStart


def test_follows_the_timing_movement(task):
    recording = MakeStaticLoop(task).Run()
    error = np.abs(recording.q - recording.reference_q)
    assert np.all(error.mean(axis=0) < 0.02)
    assert np.all(error.max(axis=0) < 0.05)


@pytest.mark.parametrize("load_mass", [0.0, 5.0])
def test_settles_in_the_posture_to_hold(task, load_mass):
    t = np.arange(101) * CONTROL_STEP
    still = np.zeros((len(t), 2))
    held = Reference(t, still + np.deg2rad([-20, 80]), still, still, still)
    holding = replace(task, reference=held, load_mass=load_mass, start=ReferenceStart(noise=0.02))
    recording = MakeStaticLoop(holding).Run(np.random.default_rng(0))
    np.testing.assert_allclose(recording.q[-10:], held.q[-10:], atol=0.002)
    np.testing.assert_allclose(recording.v[-10:], 0.0, atol=0.02)
