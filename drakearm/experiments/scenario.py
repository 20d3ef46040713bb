"""Scenarios: the movements of the paper, each a YAML file: what to plan and how to learn it."""

from dataclasses import field, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import yaml
from pydantic import ConfigDict, Field, TypeAdapter, ValidationError, field_validator
from pydantic.dataclasses import dataclass

from drakearm.diagrams import TrackingTask
from drakearm.errors import ScenarioError
from drakearm.experiments.catalog import find_scenario
from drakearm.experiments.choices import Preset
from drakearm.learning import PAPER, PpoSettings
from drakearm.model import load_arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import Reference
from drakearm.planning import Movement
from drakearm.systems import OBSERVATIONS, RewardWeights

_STRICT = ConfigDict(extra="forbid")

NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


@dataclass(frozen=True, config=_STRICT)
class Tracking:
    """How the movement is sensed and rewarded while it is learned."""

    reward: RewardWeights
    observation: str = "full"  # see `Proprioception`
    start_noise_deg: NotNegative = 0.0  # standard deviation of the joint angles at the start

    @field_validator("observation")
    @classmethod
    def _known(cls, observation: str) -> str:
        if observation not in OBSERVATIONS:
            raise ValueError(f"expected one of {', '.join(OBSERVATIONS)}")
        return observation


@dataclass(frozen=True, config=_STRICT)
class Scenario:
    """One movement: what a file in `scenarios/` or of a user's own holds."""

    name: str
    description: str
    movement: Movement  # what is planned
    tracking: Tracking  # what is learned
    arm: str = "arm14"  # name of a shipped arm, or folder of a user's own, from the scenario file's folder
    load_mass: NotNegative = 0.0  # kg, welded to the hand
    obstacle: Obstacle | None = None  # what the plan goes around
    training: PpoSettings = field(default_factory=PpoSettings)
    preset: Preset = Preset.drakearm

    def task(self, reference: Reference) -> TrackingTask:
        """The task of following a reference, as the scenario wants it sensed and rewarded."""
        return TrackingTask(
            arm=load_arm(self.arm),
            reference=reference,
            reward=self.tracking.reward,
            observation=self.tracking.observation,
            load_mass=self.load_mass,
            start_noise=np.deg2rad(self.tracking.start_noise_deg),
            obstacle=self.obstacle,
        )


def load_scenario(scenario: str | Path) -> Scenario:
    """The scenario of a shipped name or a file. Raises ScenarioError, naming file and field, where it is not valid."""
    file = find_scenario(scenario)
    try:
        loaded = TypeAdapter(Scenario).validate_python(yaml.safe_load(file.read_text()))
    except yaml.YAMLError as error:
        raise ScenarioError(f"{file} is not valid YAML: {error}") from error
    except ValidationError as error:
        problems = "; ".join(
            f"{'.'.join(map(str, p['loc'])) or 'the file'}: {p['msg'].removeprefix('Value error, ')}"
            for p in error.errors()
        )
        raise ScenarioError(f"{file}: {problems}.") from error
    if loaded.preset is Preset.paper:
        loaded = replace(loaded, training=PAPER, tracking=replace(loaded.tracking, observation="paper"))
    own = file.resolve().parent / loaded.arm
    return replace(loaded, arm=str(own)) if (own / "muscles.yaml").is_file() else loaded
