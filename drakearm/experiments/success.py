"""The criteria by which a run is a success. A scenario file lists those of its movement.

To make a new criterion, derive a frozen dataclass from `SuccessCriterion`. Scenario files name it by its `type`.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, InstanceOf

from drakearm.errors import ScenarioError
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Positive
from drakearm.files.kinds import Kind
from drakearm.model.fields import Name
from drakearm.model.recording import Recording
from drakearm.task import TrackingTask


class SuccessCriterion(Kind):
    """Base of all criteria. metrics.json has the share of the runs that meet each criterion of the scenario."""

    @property
    def name(self) -> str:
        """The criterion's key in metrics.json, by default its type. Each criterion of a scenario has another one."""
        return self.type

    def __call__(self, task: TrackingTask, recording: Recording, metrics: Mapping[str, Any]) -> bool:
        """Whether a run of the task is a success. metrics: what `run_metrics` finds in its recording."""
        raise NotImplementedError

    def check(self, task: TrackingTask) -> None:
        """Raises ScenarioError if the criterion does not fit the task. By default, every criterion fits every task."""


Success = Annotated[InstanceOf[SuccessCriterion], BeforeValidator(SuccessCriterion.read)]  # as a scenario file has it


@checked_dataclass(kw_only=True)
class JointError(SuccessCriterion):
    """The error of each joint is small: its mean or its largest during the movement, or that at the end."""

    type = "joint_error"
    of: Literal["mean", "largest", "end"]
    below: Positive  # rad
    joints: Annotated[tuple[Name, ...], Field(min_length=1, max_length=10)] | None = None  # default: all

    @property
    def name(self) -> str:
        """Such as "end_error", or "elbow_end_error" if it is about the elbow only."""
        return "_".join([*(self.joints or ()), self.of, "error"])

    def __call__(self, task: TrackingTask, recording: Recording, metrics: Mapping[str, Any]) -> bool:
        key = {"mean": "tracking_error_mean", "largest": "tracking_error_max", "end": "end_error"}[self.of]
        error = dict(zip(task.arm.coordinates, metrics[key], strict=True))
        return all(error[joint] < self.below for joint in self.joints or error)

    def check(self, task: TrackingTask) -> None:
        for joint in self.joints or ():
            if joint not in task.arm.coordinates:
                raise ScenarioError(
                    f"A criterion of success names the joint {joint}: expected {', '.join(task.arm.coordinates)}."
                )


@checked_dataclass(kw_only=True)
class HandAtGoal(SuccessCriterion):
    """At the end the tip of the hand is near to the place where the reference ends."""

    type = "hand_at_goal"
    within: Positive  # m

    def __call__(self, task: TrackingTask, recording: Recording, metrics: Mapping[str, Any]) -> bool:
        return bool(metrics["hand_end_error_cm"] < 100.0 * self.within)


@checked_dataclass(kw_only=True)
class NoContact(SuccessCriterion):
    """No part of the arm's outline touches the obstacle at any time."""

    type = "no_contact"

    def __call__(self, task: TrackingTask, recording: Recording, metrics: Mapping[str, Any]) -> bool:
        return bool(metrics["clearance_cm"] > 0.0)

    def check(self, task: TrackingTask) -> None:
        if task.obstacle is None or not task.arm.outline:
            raise ScenarioError(
                "The criterion no_contact needs an obstacle in the scenario, and an outline of the arm: found none."
            )


FOLLOWS = JointError(of="mean", below=0.1)  # the criterion of a scenario that lists none
