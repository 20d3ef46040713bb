"""Perturbation: the base of all that disturbs an arm without its controller's knowledge.

A perturbation of your own is a frozen dataclass with a `type` that derives from `Perturbation` and overrides one of its
methods. drakearm's own ones are in perturbations.py and start_perturbations.py.
"""

from collections.abc import Iterable
from typing import Annotated, Protocol, TypeVar, runtime_checkable

import numpy as np
from pydantic import BeforeValidator, InstanceOf
from pydrake.systems.framework import Context, DiagramBuilder, OutputPort, System

from drakearm.diagrams.connections import reroute
from drakearm.diagrams.muscle_arm import MuscleArm
from drakearm.files.kinds import Kind
from drakearm.task import TrackingTask

_System = TypeVar("_System", bound=System)


class Perturbation(Kind):
    """Base of all perturbations. Each method returns what it is given unless a perturbation overrides it.

    A method that gets an output port may add systems to the builder, with `add_system`, and return the port of one of
    them. What reads the given port then reads the returned one. Where a task has several perturbations, each one gets
    what the one before it returned.
    """

    def perturb_task(self, task: TrackingTask) -> TrackingTask:
        """The task of the arm that moves: its muscles, its load and its start. The controller knows the given task."""
        return task

    def perturb_excitation(self, builder: DiagramBuilder, excitation: OutputPort) -> OutputPort:
        """The excitations (n,) that reach the muscles, from those that the controller decides, which may leave 0..1."""
        return excitation

    def perturb_sense(self, builder: DiagramBuilder, name: str, signal: OutputPort) -> OutputPort:
        """What the controller gets of a signal of its body.

        name: arm_state, activation, fiber_length, fiber_velocity or tendon_force, see `drakearm.task.SIGNALS`. The
        reference, its preview and the controller's own excitations cannot be perturbed.
        """
        return signal

    def perturb_torque(self, builder: DiagramBuilder, torque: OutputPort, arm: MuscleArm) -> OutputPort:
        """The generalized force (n_q,), Nm, on the plant, from that of the muscles and the joint stops."""
        return torque

    def add_system(self, builder: DiagramBuilder, system: _System) -> _System:
        """Adds a system to a builder, under the `type` of the perturbation and a number, and returns the system."""
        return builder.AddNamedSystem(f"{self.type}_{len(builder.GetSystems())}", system)


# As a scenario file has it: see `Kind.read`.
FilePerturbation = Annotated[InstanceOf[Perturbation], BeforeValidator(Perturbation.read)]


@runtime_checkable
class BeginsRun(Protocol):
    """A system that has to be prepared for each run, such as `Noise` and `DelayLine`."""

    def Begin(self, root_context: Context, rng: np.random.Generator | None = None) -> None:
        """Prepares the system. The time and the state of the arm are set already."""


def perturb_plant(builder: DiagramBuilder, arm: MuscleArm, perturbations: Iterable[Perturbation]) -> None:
    """Puts the perturbations between the torques of muscles and stops and the plant, where they are connected."""

    def perturbed(torque: OutputPort) -> OutputPort:
        for perturbation in perturbations:
            torque = perturbation.perturb_torque(builder, torque, arm)
        return torque

    reroute(builder, arm.plant.get_applied_generalized_force_input_port(), perturbed)
