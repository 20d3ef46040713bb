"""Repertoires: YAML files that say which movements one policy learns, and how. drakearm ships some."""

from dataclasses import field, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from drakearm.experiments.catalog import find_file
from drakearm.experiments.scenario import ArmName, Tracking, read_file
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import FileName, PlainText, Whole
from drakearm.learning import PpoSettings
from drakearm.model import Arm, Obstacle, load_arm
from drakearm.model.reference import Reference
from drakearm.planning.library import Library
from drakearm.planning.movement_source import Source
from drakearm.task import ReferenceStart, TrackingTask, observation_set
from drakearm.task.episode import Delay, FileRandomization

_SHIPPED = Path(__file__).parent / "files"


@checked_dataclass()
class Movements:
    """Which movements are planned."""

    source: Source
    count: Annotated[Whole, Field(ge=1, le=100_000)] = 512
    seed: Annotated[Whole, Field(ge=0, le=2**32 - 1)] = 0


@checked_dataclass()
class Repertoire:
    """The content of a repertoire file."""

    name: FileName
    description: PlainText
    movements: Movements
    tracking: Tracking  # what is learned
    senses_delay: Delay = 0.0  # s: what the policy senses of the body is this old
    randomization: Annotated[tuple[FileRandomization, ...], Field(max_length=50)] = ()
    arm: ArmName = "arm14"
    training: PpoSettings = field(default_factory=PpoSettings)

    @cached_property
    def loaded_arm(self) -> Arm:
        """The arm of the file. Raises ArmError if there is none."""
        return load_arm(self.arm)

    def task(self, reference: Reference, load_mass: float = 0.0) -> TrackingTask:
        """The task to follow a reference with a load (kg), with the senses, delay and randomization of the file."""
        return TrackingTask(
            arm=self.loaded_arm,
            reference=reference,
            reward=self.tracking.reward,
            senses=observation_set(self.tracking.observation),
            start=ReferenceStart(noise=np.deg2rad(self.tracking.start_noise_deg)),
            load_mass=load_mass,
            senses_delay=self.senses_delay,
            randomization=self.randomization,
        )

    def exact_task(
        self, reference: Reference, load_mass: float = 0.0, obstacle: Obstacle | None = None
    ) -> TrackingTask:
        """`task` without what is random: the arm starts on the reference, and its body is as it is in the file."""
        task = self.task(reference, load_mass)
        return replace(task, start=ReferenceStart(), randomization=(), obstacle=obstacle)

    def tasks(self, library: Library) -> list[TrackingTask]:
        """The tasks of all movements of a library."""
        references = library.references
        first = self.task(references[0])
        pairs = zip(references, library.load_mass.tolist(), strict=True)
        return [replace(first, reference=reference, load_mass=load_mass) for reference, load_mass in pairs]


def repertoire_files() -> dict[str, Path]:
    """The shipped repertoires: name and file."""
    return {file.stem: file for file in sorted(_SHIPPED.glob("*.yaml"))}


def find_repertoire(repertoire: str | Path) -> Path:
    """The file of a shipped repertoire, or the given path. Raises ScenarioError, with all names, if there is none."""
    return find_file(repertoire, repertoire_files(), "repertoire")


def load_repertoire(repertoire: str | Path) -> Repertoire:
    """Loads a shipped repertoire by its name, or a file. Raises ScenarioError, with file and field, if invalid."""
    return read_file(find_repertoire(repertoire), Repertoire)
