"""drakearm's perturbations of the state in which a run starts."""

from collections.abc import Sequence
from dataclasses import dataclass as plain_dataclass
from dataclasses import replace
from typing import Annotated

import numpy as np
from pydantic import Field
from pydrake.symbolic import Expression, Variable

from drakearm.diagrams.perturbation import Perturbation
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Degrees, NonNegative
from drakearm.model.reference import Reference
from drakearm.task import Start, StartState, TrackingTask


@checked_dataclass()
class StartOffset(Perturbation):
    """All joint angles differ from the start that the controller knows. They stay in the ranges of the joints."""

    type = "start_offset"
    angle_deg: Degrees

    def perturb_task(self, task: TrackingTask) -> TrackingTask:
        return replace(task, start=_Offset(task.start, np.deg2rad(self.angle_deg)))


@checked_dataclass()
class StartNoise(Perturbation):
    """Normal noise on the joint angles and the activations of the start, beside the noise that the start has itself.

    Joint angles stay in the ranges of the joints, activations between their minimum and 1.
    """

    type = "start_noise"
    posture_deg: Annotated[NonNegative, Field(le=90.0)] = 0.0  # standard deviation
    activation: Annotated[NonNegative, Field(le=1.0)] = 0.0  # standard deviation

    def perturb_task(self, task: TrackingTask) -> TrackingTask:
        least = task.arm.muscle_table["minimum_activation"]
        return replace(task, start=_Noisy(task.start, np.deg2rad(self.posture_deg), self.activation, least))


@plain_dataclass(frozen=True)
class _Offset(Start):
    """Another start with all joint angles changed by an offset (rad)."""

    start: Start
    offset: float

    def __call__(self, reference: Reference, rng: np.random.Generator | None) -> StartState:
        state = self.start(reference, rng)
        return state._replace(q=state.q + self.offset)

    def random_posture(self, reference: Reference) -> Sequence[Expression]:
        return [angle + self.offset for angle in self.start.random_posture(reference)]


@plain_dataclass(frozen=True)
class _Noisy(Start):
    """Another start with noise on joint angles (rad) and activations. least: the smallest activations (n,)."""

    start: Start
    posture: float
    activation: float
    least: np.ndarray

    def __call__(self, reference: Reference, rng: np.random.Generator | None) -> StartState:
        state = self.start(reference, rng)
        if rng is None:
            return state
        q = state.q + self.posture * rng.standard_normal(len(state.q))
        activation = state.activation + self.activation * rng.standard_normal(len(self.least))
        return state._replace(q=q, activation=np.clip(activation, self.least, 1.0))

    def random_posture(self, reference: Reference) -> Sequence[Expression]:
        return [
            angle + self.posture * Variable(f"perturbed_start_{j}", Variable.Type.RANDOM_GAUSSIAN)
            for j, angle in enumerate(self.start.random_posture(reference))
        ]
