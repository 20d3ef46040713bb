"""Fixtures that all tests share."""

from pathlib import Path

import numpy as np
import pytest

from drakearm.model import Arm, load_arm
from drakearm.model.reference import CONTROL_STEP, Reference
from drakearm.task import ReferenceStart, RewardWeights, TrackingTask

ORACLE = Path(__file__).parents[2] / "shared" / "oracle"


@pytest.fixture(scope="session")
def arm() -> Arm:
    return load_arm("arm14")


@pytest.fixture(scope="session")
def oracle():
    """Loads an array file with results of OpenSim. Skips the test if the file is missing."""

    def load(name: str):
        if not (ORACLE / name).is_file():
            pytest.skip(f"the file {name} with results of OpenSim is missing")
        return np.load(ORACLE / name)

    return load


@pytest.fixture(scope="session")
def reference() -> Reference:
    """A minimum-jerk movement of the elbow from 0 to 90 degrees in 0.7 s, then rest. It is not planned."""
    t = np.arange(76) * CONTROL_STEP
    s = np.minimum(t / 0.7, 1.0)
    q, v, a = np.zeros((3, len(t), 2))
    q[:, 1] = np.pi / 2 * (10 * s**3 - 15 * s**4 + 6 * s**5)
    v[:, 1] = np.pi / 2 / 0.7 * (30 * s**2 - 60 * s**3 + 30 * s**4)
    a[:, 1] = np.pi / 2 / 0.7**2 * (60 * s - 180 * s**2 + 120 * s**3)
    return Reference(t, q, v, a, np.zeros_like(q))


@pytest.fixture(scope="session")
def task(arm, reference) -> TrackingTask:
    weights = RewardWeights(position=(10.0, 10.0), velocity=(0.1, 0.1), acceleration=(1e-6, 1e-6))
    return TrackingTask(arm, reference, weights, start=ReferenceStart(noise=0.01))
