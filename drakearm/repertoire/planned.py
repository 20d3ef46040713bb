"""A movement that is planned, so that any policy, or static optimization, can make it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drakearm.errors import PlanningError
from drakearm.experiments import RunFolder, Scenario
from drakearm.experiments.success import HandAtGoal, SuccessCriterion
from drakearm.model.reference import Reference
from drakearm.planning import Feasibility, Movement, PlanningModel, muscle_feasibility, plan, posture_at, reach
from drakearm.repertoire.repertoire import Repertoire
from drakearm.repertoire.to_place import NEAR, START_DEG, described, reach_past
from drakearm.task import TrackingTask

_REACH_TO, _REACH_TIME = (0.4, 0.6), 0.6  # m, s


@dataclass(frozen=True)
class PlannedMovement:
    """A movement, the task to follow its plan, and when it is a success.

    weakness: why the muscles cannot make it; empty if they can.
    """

    name: str
    description: str
    movement: Movement
    task: TrackingTask
    success: Sequence[SuccessCriterion]
    weakness: str = ""

    @classmethod
    def of_run(cls, run: RunFolder) -> "PlannedMovement":
        """The movement of a run. Raises RunFolderError if the run has no plan."""
        scenario, feasibility = run.scenario(), run.read_json("plan", "plan")["feasibility"]
        weakness = "" if feasibility["feasible"] else feasibility["verdict"]
        return cls(
            scenario.name, scenario.description, scenario.movement, run.task(scenario), scenario.success, weakness
        )

    @classmethod
    def of_scenario(cls, scenario: Scenario) -> "PlannedMovement":
        """Plans the movement of a scenario. Raises PlanningError if there is no plan."""
        arm = scenario.loaded_arm
        reference = plan(arm, scenario.movement, scenario.load_mass, scenario.obstacle).reference
        feasibility = muscle_feasibility(arm, reference, scenario.load_mass)
        return cls(
            scenario.name,
            scenario.description,
            scenario.movement,
            scenario.task(reference),
            scenario.success,
            _weakness(feasibility),
        )

    @classmethod
    def of_repertoire(cls, repertoire: Repertoire) -> "PlannedMovement":
        """An example of what a repertoire's policy can do: a reach to the front, which is planned here.

        Raises PlanningError if its arm is not like the shipped one, which has two joints.
        """
        arm = repertoire.loaded_arm
        if len(arm.coordinates) != len(START_DEG):
            raise PlanningError(
                f"The arm {arm.name} has {len(arm.coordinates)} joints, so there is no example of its movements: "
                "expected `drakearm replay SCENARIO --policy FILE`."
            )
        target = posture_at(PlanningModel(arm), *_REACH_TO, near=np.deg2rad(START_DEG))
        movement = reach(START_DEG, np.rad2deg(target), _REACH_TIME)
        reference = plan(arm, movement).reference
        return cls(
            "reach",
            described(_REACH_TO, _REACH_TIME, 0.0),
            movement,
            replace(repertoire.task(reference), randomization=()),
            [HandAtGoal(within=NEAR)],
            _weakness(muscle_feasibility(arm, reference, 0.0)),
        )

    def changed(self, to: tuple[float, float] | None, load_mass: float) -> "PlannedMovement":
        """The movement planned anew with another load (kg), and to another place of the hand, x and y (m), if given.

        Raises PlanningError if the hand cannot reach the place, if there is no plan, or if the muscles are too weak.
        """
        arm, movement, obstacle = self.task.arm, self.movement, self.task.obstacle
        if to is not None:
            target = posture_at(PlanningModel(arm, load_mass), *to, near=self.task.reference.q[-1])
            movement = reach_past(obstacle, movement.start_deg, target, self._seconds, movement.hold)
        reference: Reference = plan(arm, movement, load_mass, obstacle).reference
        feasibility = muscle_feasibility(arm, reference, load_mass)
        if not feasibility.feasible:
            raise PlanningError(feasibility.verdict)
        task = replace(self.task, reference=reference, load_mass=load_mass)
        description = described(to, self._seconds, load_mass) if to else f"{self.name} with {load_mass:g} kg"
        return replace(self, description=description, movement=movement, task=task, weakness="")

    @property
    def _seconds(self) -> float:
        """How long the movement takes, without the rest at its end."""
        return self.task.reference.duration - self.movement.hold


def _weakness(feasibility: Feasibility) -> str:
    return "" if feasibility.feasible else feasibility.verdict
