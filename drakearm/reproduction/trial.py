"""A trial: one movement, made by one method with one seed. Its outcome is all that tables and figures are made from."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from drakearm.model.recording import Recording
from drakearm.planning.feasibility import Feasibility
from drakearm.task import TrackingTask


class Method(StrEnum):
    """A way to find the excitations. The value is its name in tables and figures."""

    static = "static optimization"  # computed muscle control, without learning
    ppo_alone = "PPO alone"  # as in the paper: 28 observations, random weights, no teacher
    default = "default"  # the settings of the scenario file


@dataclass(frozen=True)
class Trial:
    """One movement, learned (or not) by one method with one seed."""

    scenario: str  # name of a shipped scenario, or the path of a file
    method: Method
    seed: int = 0


@dataclass(frozen=True)
class Outcome:
    """What a trial gave."""

    trial: Trial
    task: TrackingTask
    noise_free: Recording
    noisy: tuple[Recording, ...]  # excitations sampled from the policy, if there is one, and noisy starts
    perturbed: tuple[Recording, ...]  # with the perturbations of the scenario; empty if it has none
    metrics: Mapping[str, Any]  # the content of metrics.json
    learning_curve: Mapping[str, np.ndarray] | None  # the columns of training.csv; None for static optimization
    feasibility: Feasibility  # what static strength predicts
    seconds: Mapping[str, float]  # that each part took: "plan", "train", "evaluate"
