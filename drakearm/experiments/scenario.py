"""Scenarios: YAML files that say which movement to plan and how to learn it. drakearm ships some."""

import os
from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
from pydantic import BeforeValidator, Field, InstanceOf, TypeAdapter, ValidationError, field_validator

from drakearm.diagrams.perturbation import FilePerturbation
from drakearm.errors import ScenarioError
from drakearm.experiments.catalog import find_scenario
from drakearm.experiments.choices import Preset
from drakearm.experiments.success import FOLLOWS, Success
from drakearm.files import read_yaml
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import FileName, NonNegative, PlainText
from drakearm.files.problems import file_error
from drakearm.learning import PAPER, PpoSettings
from drakearm.model import Arm, load_arm
from drakearm.model.obstacle import Obstacle
from drakearm.model.reference import Reference
from drakearm.planning import Movement
from drakearm.task import OBSERVATIONS, ReferenceStart, Reward, RewardWeights, TrackingTask, observation_set

_WithArm = TypeVar("_WithArm", bound=Any)
ArmName = Annotated[PlainText, Field(min_length=1, max_length=1000)]


def _read_reward(value: Any) -> Reward:
    """Reads a reward from a mapping. Without a `type`, the mapping has the weights of the paper's reward."""
    if isinstance(value, Mapping) and "type" not in value:
        value = {"type": RewardWeights.type, **value}
    return Reward.read(value)


@checked_dataclass()
class Tracking:
    """What the arm senses and how it is rewarded during the training."""

    reward: Annotated[InstanceOf[Reward], BeforeValidator(_read_reward)]
    observation: str = "full"  # name of a set in `drakearm.task.OBSERVATIONS`
    start_noise_deg: Annotated[NonNegative, Field(le=90.0)] = 0.0  # standard deviation of the joint angles at the start

    @field_validator("observation")
    @classmethod
    def _known(cls, observation: str) -> str:
        if observation not in OBSERVATIONS:
            raise ValueError(f"expected one of {', '.join(OBSERVATIONS)}")
        return observation


@checked_dataclass()
class Scenario:
    """The content of a scenario file: one movement, and how to learn it."""

    name: FileName  # also of the folder of its runs
    description: PlainText
    movement: Movement  # what is planned
    tracking: Tracking  # what is learned
    arm: ArmName = "arm14"  # name of a shipped arm, or a user's folder, relative to the scenario file
    load_mass: Annotated[NonNegative, Field(le=1000.0)] = 0.0  # kg, welded to the hand
    obstacle: Obstacle | None = None  # which the plan avoids
    perturbations: Annotated[tuple[FilePerturbation, ...], Field(max_length=50)] = ()  # of the robustness runs
    success: Annotated[tuple[Success, ...], Field(max_length=20)] = (FOLLOWS,)  # when a run is one
    training: PpoSettings = field(default_factory=PpoSettings)
    preset: Preset = Preset.drakearm

    @field_validator("success")
    @classmethod
    def _different(cls, success: tuple[Success, ...]) -> tuple[Success, ...]:
        names = [criterion.name for criterion in success]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"found two criteria with the name {name}, expected different ones")
        return success

    @cached_property
    def loaded_arm(self) -> Arm:
        """The arm of the file. Raises ArmError if there is none."""
        return load_arm(self.arm)

    def task(self, reference: Reference) -> TrackingTask:
        """The task to follow a reference, with the senses, reward, start, load and obstacle of the scenario.

        Raises ScenarioError or TaskError if the scenario's criteria of success, or its reward, do not fit the arm.
        """
        task = TrackingTask(
            arm=self.loaded_arm,
            reference=reference,
            reward=self.tracking.reward,
            senses=observation_set(self.tracking.observation),
            start=ReferenceStart(noise=np.deg2rad(self.tracking.start_noise_deg)),
            load_mass=self.load_mass,
            obstacle=self.obstacle,
        )
        for criterion in self.success:
            criterion.check(task)
        return task


def load_scenario(scenario: str | Path, preset: Preset | None = None) -> Scenario:
    """Loads a shipped scenario by its name, or a file. preset: replaces the one in the file.

    Raises ScenarioError, which names file and field, if invalid.
    """
    loaded = read_file(find_scenario(scenario), Scenario)
    loaded = replace(loaded, preset=preset or loaded.preset)
    if loaded.preset is Preset.paper:
        return replace(loaded, training=PAPER, tracking=replace(loaded.tracking, observation="paper"))
    return loaded


def read_file(file: Path, kind: type[_WithArm]) -> _WithArm:
    """Reads a dataclass that has a field `arm`. The folder of an arm may be relative to the file.

    Raises ScenarioError, which names file and field, if the content is invalid.
    """
    content = read_yaml(file, ScenarioError)
    try:
        loaded = TypeAdapter(kind).validate_python(content)
    except ValidationError as error:
        raise file_error(ScenarioError, error, file, content, kind) from error
    own = file.resolve().parent / loaded.arm
    return replace(loaded, arm=str(own)) if os.path.isfile(own / "muscles.yaml") else loaded
