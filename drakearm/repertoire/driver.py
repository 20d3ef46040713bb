"""What drives the muscles in a movement: a policy of one movement or of many, or static optimization."""

import os
from dataclasses import dataclass
from pathlib import Path

from pydrake.geometry import Meshcat

from drakearm.diagrams import MakePolicyLoop, MakeStaticLoop, TrackingLoop
from drakearm.errors import PolicyFileError, shown
from drakearm.experiments import run_metrics, scenario_files
from drakearm.experiments.captions import caption
from drakearm.learning import Policy
from drakearm.repertoire.planned import PlannedMovement
from drakearm.repertoire.repertoire import Repertoire, load_repertoire, repertoire_files
from drakearm.repertoire.shipped import policy_and_repertoire, shipped_policy
from drakearm.replay import RecordedMovement
from drakearm.task import TrackingTask

STATIC = "static"
POLICY_FILE = ".safetensors"


@dataclass(frozen=True)
class Driver:
    """policy: None for static optimization. repertoire: of a policy that has learned many movements."""

    name: str
    policy: Policy | None = None
    repertoire: Repertoire | None = None

    @property
    def makes_all_movements(self) -> bool:
        """Whether it is made for all movements, and not for one of them."""
        return self.policy is None or self.repertoire is not None

    def fits(self, planned: PlannedMovement) -> bool:
        """Whether a movement is one of the arm that the policy moves."""
        return self.repertoire is None or self.repertoire.loaded_arm == planned.task.arm

    def task(self, planned: PlannedMovement) -> TrackingTask:
        """The task of a planned movement, with the senses that the policy needs.

        Raises PolicyFileError if the policy is for another arm, or was trained with other senses.
        """
        task = planned.task
        if not self.fits(planned):
            raise PolicyFileError(
                f"{self.name} is not for the arm {task.arm.name} of {planned.name}: expected a policy for the same arm."
            )
        if self.repertoire is not None:
            task = self.repertoire.exact_task(task.reference, task.load_mass, task.obstacle)
        if self.policy is not None:
            self.policy.check(task)
        return task

    def loop(self, planned: PlannedMovement, meshcat: Meshcat | None = None) -> TrackingLoop:
        """The closed loop that makes a planned movement; drawn live if a Meshcat is given."""
        task = self.task(planned)
        if self.policy is None:
            return MakeStaticLoop(task, meshcat=meshcat)
        return MakePolicyLoop(task, self.policy.act, meshcat)

    def record(self, planned: PlannedMovement, title: str) -> RecordedMovement:
        """Makes a planned movement once, without noise."""
        task, recording = self.task(planned), self.loop(planned).Run()
        metrics = run_metrics(task, recording, planned.success)
        words = caption(title, planned.description, metrics, planned.weakness)
        return RecordedMovement(task.arm, recording, task.load_mass, task.obstacle, words)


def is_driver(name: str) -> bool:
    """Whether a name stands for static optimization, a shipped repertoire, or the file of a policy."""
    return name == STATIC or name in repertoire_files() or name.endswith(POLICY_FILE)


def find_driver(name: str) -> Driver:
    """What a name stands for: static optimization, the policy of a shipped repertoire, or that of a file.

    Raises PolicyFileError if the name stands for nothing, or if the file has no policy.
    """
    if not is_driver(name):
        known = ", ".join((STATIC, *repertoire_files()))
        raise PolicyFileError(
            f"{shown(Path(name))} is no policy: expected a file with the ending {POLICY_FILE}, or one of {known}."
        )
    if name == STATIC:
        return Driver("static optimization")
    if name in repertoire_files():
        return Driver(f"policy {name}", shipped_policy(name), load_repertoire(name))
    policy = Policy.load(name)
    if "repertoire" in policy.metadata:
        policy, repertoire = policy_and_repertoire(Path(name))
        return Driver(f"policy {repertoire.name}", policy, repertoire)
    return Driver(f"policy {policy.metadata.get('scenario', Path(name).stem)}", policy)


def scenario_of_policy(file: Path, policy: Policy) -> Path | str:
    """The scenario that a policy of one movement was trained for: the file beside it, or the name of a shipped one.

    Raises PolicyFileError if the file does not say it, or if drakearm does not ship the scenario.
    """
    beside = file.parent / "scenario.yaml"
    if os.path.isfile(beside):
        return beside
    name = str(policy.metadata.get("scenario"))
    if name not in scenario_files():
        raise PolicyFileError(
            f"{shown(file)} has no scenario.yaml beside it, and was not trained for a scenario of drakearm: "
            "expected `drakearm replay SCENARIO --policy FILE`."
        )
    return name
