"""Scenarios: the movements of the paper, each a YAML file: what to plan and how to learn it."""

import re
from collections.abc import Mapping
from dataclasses import field, replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import yaml
from pydantic import BeforeValidator, ConfigDict, InstanceOf, TypeAdapter, ValidationError, field_validator
from pydantic.dataclasses import dataclass

from drakearm.errors import ScenarioError
from drakearm.learning import PAPER, PpoSettings
from drakearm.model import load_arm
from drakearm.model.fields import NonNegative
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import Reference
from drakearm.planning import Movement
from drakearm.task import OBSERVATIONS, ReferenceStart, Reward, RewardWeights, TrackingTask, observation_set

_SHIPPED = Path(__file__).parent / "scenarios"
_STRICT = ConfigDict(extra="forbid")


class Preset(StrEnum):
    """Where the settings of observation and training come from that a scenario file does not give."""

    drakearm = "drakearm"
    paper = "paper"  # 28 observations, learned from random weights; overrules the file's own settings


def _read_reward(value: Any) -> Reward:
    """The reward of a mapping. Without a `type` it holds the weights of the paper's reward."""
    if isinstance(value, Mapping) and "type" not in value:
        value = {"type": RewardWeights.type, **value}
    return Reward.read(value)


@dataclass(frozen=True, config=_STRICT)
class Tracking:
    """How the movement is sensed and rewarded while it is learned."""

    reward: Annotated[InstanceOf[Reward], BeforeValidator(_read_reward)]
    observation: str = "full"  # a set in `drakearm.task.OBSERVATIONS`
    start_noise_deg: NonNegative = 0.0  # standard deviation of the joint angles at the start

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
    load_mass: NonNegative = 0.0  # kg, welded to the hand
    obstacle: Obstacle | None = None  # what the plan goes around
    training: PpoSettings = field(default_factory=PpoSettings)
    preset: Preset = Preset.drakearm

    def task(self, reference: Reference) -> TrackingTask:
        """The task of following a reference, sensed and rewarded as the scenario says."""
        return TrackingTask(
            arm=load_arm(self.arm),
            reference=reference,
            reward=self.tracking.reward,
            senses=observation_set(self.tracking.observation),
            start=ReferenceStart(noise=np.deg2rad(self.tracking.start_noise_deg)),
            load_mass=self.load_mass,
            obstacle=self.obstacle,
        )


def scenario_files() -> dict[str, Path]:
    """The shipped scenarios: name and file, 2 kg before 10 kg."""

    def numbers(file: Path) -> list[str | int]:
        return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", file.stem)]

    return {file.stem: file for file in sorted(_SHIPPED.glob("*.yaml"), key=numbers)}


def find_scenario(scenario: str | Path) -> Path:
    """The file of a shipped scenario's name, or a path. Raises ScenarioError, listing the names, for all else."""
    shipped = scenario_files()
    file = shipped.get(str(scenario), Path(scenario))
    if not file.is_file():
        raise ScenarioError(
            f"There is no scenario {str(scenario)!r}: expected the path of a file or one of {', '.join(shipped)}."
        )
    return file


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
