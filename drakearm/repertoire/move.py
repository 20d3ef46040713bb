"""One movement on demand: planned, tested, and carried out by the muscles under a policy of a repertoire."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from drakearm.errors import PlanningError
from drakearm.experiments.captions import caption
from drakearm.experiments.metrics import run_metrics, run_policy
from drakearm.experiments.success import HandAtGoal
from drakearm.figures.movement_picture import Movement, write_movement_picture
from drakearm.learning import Policy
from drakearm.model import Recording
from drakearm.model.obstacle import Obstacle
from drakearm.planning import PlanningModel, muscle_feasibility, plan, posture_at
from drakearm.planning.plan_report import PlanReport
from drakearm.repertoire.repertoire import Repertoire
from drakearm.repertoire.to_place import NEAR, START_DEG, described, reach_past
from drakearm.replay import write_replay
from drakearm.task import TrackingTask

_BAR = 0.3  # m, length of the obstacle that is drawn
_HOLD = 0.2  # s of rest after the movement


@dataclass(frozen=True)
class Move:
    """A movement that was made: what was planned, what the arm did, and how good it was (`run_metrics`)."""

    report: PlanReport
    task: TrackingTask
    recording: Recording
    metrics: dict[str, Any]

    def save(self, folder: Path) -> list[Path]:
        """Writes the plan, the recording, a picture of the movement and the replay. Returns the files."""
        names = ("reference.npz", "recording.npz", "movement.png", "replay.html")
        reference, recording, movement, replay = files = [folder / name for name in names]
        self.task.reference.save(reference)
        self.recording.save(recording)
        metrics = {"joints": list(self.task.arm.coordinates), "noise_free": self.metrics, "success_rate": {}}
        write_movement_picture(
            Movement(self.task, self.recording, [], metrics, self.report.name, self.report.description), movement
        )
        write_replay(
            replay,
            self.task.arm,
            self.recording,
            load_mass=self.task.load_mass,
            obstacle=self.task.obstacle,
            caption=caption("move", self.report.description, self.metrics),
        )
        return files


def move(
    repertoire: Repertoire,
    policy: Policy,
    to: tuple[float, float],
    *,
    start_deg: Sequence[float] = START_DEG,
    duration: float = 0.6,
    load_mass: float = 0.0,
    avoid: tuple[float, float, float] | None = None,
) -> Move:
    """Moves the hand to x and y (m, in the world), from rest at the angles start_deg, in a duration (s).

    load_mass: kg, in the hand; the policy is not told. avoid: x, y and radius (m) of a bar across the plane of the
    movement. Raises PlanningError, before anything moves, if the hand cannot reach the position, if there is no plan,
    or if the muscles are too weak for it.
    """
    arm = repertoire.loaded_arm
    if len(start_deg) != len(arm.coordinates):
        raise PlanningError(
            f"The start has {len(start_deg)} angles: expected {len(arm.coordinates)}, for {', '.join(arm.coordinates)}."
        )
    model = PlanningModel(arm, load_mass)
    start = np.deg2rad(np.array(start_deg, dtype=float))
    target = posture_at(model, *to, near=start)
    obstacle = _bar(avoid, model, target) if avoid else None
    movement = reach_past(obstacle, start_deg, target, duration, _HOLD)
    planned = plan(arm, movement, load_mass, obstacle)
    feasibility = muscle_feasibility(arm, planned.reference, load_mass)
    if not feasibility.feasible:
        raise PlanningError(f"{feasibility.verdict} {feasibility.advice}")
    task = repertoire.exact_task(planned.reference, load_mass, obstacle)
    recording = run_policy(task, policy)
    report = PlanReport(
        name="move",
        description=described(to, duration, load_mass),
        arm=arm,
        movement=movement,
        load_mass=load_mass,
        obstacle=obstacle,
        plan=planned,
        feasibility=feasibility,
    )
    return Move(report, task, recording, run_metrics(task, recording, [HandAtGoal(within=NEAR)]))


def _bar(avoid: tuple[float, float, float], model: PlanningModel, target: np.ndarray) -> Obstacle:
    """The bar across the plane in which the hand moves."""
    context = model.plant.CreateDefaultContext()
    model.plant.SetPositions(context, target)
    z = model.plant.GetFrameByName(model.arm.tip_frame).CalcPoseInWorld(context).translation()[2]
    return Obstacle(position=(avoid[0], avoid[1], float(z)), radius=avoid[2], length=_BAR)
