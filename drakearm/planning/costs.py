"""The costs of a movement: the base of all costs, and those of postures and torques, which are quadratic."""

from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, InstanceOf
from pydrake.solvers import Binding

from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Degrees, NonNegative
from drakearm.files.kinds import Kind
from drakearm.planning.problem import Problem

RATE_STEP = 0.04  # s: the paper's step, over which its R weighs a change of torque

Weight = NonNegative | tuple[NonNegative, ...]  # one for all coordinates, or one for each


class CostPiece(Kind):
    """Base of all costs. A cost of your own is a frozen dataclass with a `type` that derives from this class.

    A scenario file can list it by its `type` once the module that defines it is imported.
    """

    def add(self, problem: Problem) -> list[Binding]:
        """Adds the cost to a problem, and returns what it added, so that the cost's value can be reported.

        An integral over the movement is a sum over the knots. Each knot is multiplied by its share of the time
        (`problem.shares`). So a weight has the same meaning for any number of knots.
        """
        raise NotImplementedError


Cost = Annotated[InstanceOf[CostPiece], BeforeValidator(CostPiece.read)]  # as a scenario file has it: see `Kind.read`


@checked_dataclass(kw_only=True)
class Posture(CostPiece):
    """Distance to the target and speed, both squared, during the movement (integrated over time) and at its end."""

    type = "posture"
    running: Weight = 0.0  # of (q - target)^2, 1/(rad^2 s)
    running_speed: Weight = 0.0  # of v^2, s/rad^2
    final: Weight = 0.0  # of (q - target)^2 at the end, 1/rad^2
    final_speed: Weight = 0.0  # of v^2 at the end, s^2/rad^2

    def add(self, problem: Problem) -> list[Binding]:
        def error(weights: np.ndarray, knot: int) -> Binding:
            target = np.concatenate([problem.target, np.zeros_like(problem.target)])
            state = problem.collocation.state(knot)
            return problem.prog.AddQuadraticErrorCost(np.diag(weights), target, state)

        running = np.concatenate([problem.weights(self.running), problem.weights(self.running_speed)])
        final = np.concatenate([problem.weights(self.final), problem.weights(self.final_speed)])
        costs = [error(share * running, k) for k, share in enumerate(problem.shares)]
        return [*costs, error(final, len(problem.times) - 1)]


@checked_dataclass(kw_only=True)
class SwitchedTarget(CostPiece):
    """Distance to a set point, squared and integrated over time: first to a posture of its own, later to the target.

    Denizdurduran et al. 2022, eq. 9: the set point switches to the movement's target at the time t_s.
    """

    type = "switched_target"
    first_deg: tuple[Degrees, ...]  # per coordinate
    switch_time: NonNegative  # t_s, s from the start
    weight: Weight  # of (q - set point)^2, 1/(rad^2 s)

    def add(self, problem: Problem) -> list[Binding]:
        first = problem.per_coordinate(np.deg2rad(self.first_deg), "angles")
        weights = np.diag(problem.weights(self.weight))
        return [
            problem.prog.AddQuadraticErrorCost(
                share * weights, first if problem.times[k] < self.switch_time else problem.target, problem.q(k)
            )
            for k, share in enumerate(problem.shares)
        ]


@checked_dataclass(kw_only=True)
class Torque(CostPiece):
    """The joint torques squared, integrated over time."""

    type = "torque"
    weight: Weight  # of tau^2, 1/(Nm^2 s)

    def add(self, problem: Problem) -> list[Binding]:
        weights = problem.weights(self.weight)
        zero = np.zeros(len(weights))
        return [
            problem.prog.AddQuadraticErrorCost(share * np.diag(weights), zero, problem.tau(k))
            for k, share in enumerate(problem.shares)
        ]


@checked_dataclass(kw_only=True)
class TorqueRate(CostPiece):
    """The rate of the joint torques squared, integrated over time.

    This is du' R du of Denizdurduran et al. 2022, eq. 3, for any knots: (RATE_STEP dtau/dt)^2 R is integrated. With
    knots that are RATE_STEP apart, the integral is the paper's sum times RATE_STEP.
    """

    type = "torque_rate"
    weight: Weight  # the paper's R, 1/(Nm^2 s)

    def add(self, problem: Problem) -> list[Binding]:
        weights = problem.weights(self.weight)
        zero = np.zeros(2 * len(weights))
        costs = []
        for k, step in enumerate(np.diff(problem.times)):
            change = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.diag(weights))
            torques = np.concatenate([problem.tau(k), problem.tau(k + 1)])
            scale = RATE_STEP**2 / step
            # AddQuadraticCost halves its matrix. The matrix is singular, but the cost is convex.
            costs.append(problem.prog.AddQuadraticCost(2.0 * scale * change, zero, torques, is_convex=True))
        return costs


@checked_dataclass(kw_only=True)
class HeldJoint(CostPiece):
    """The distance of one joint from an angle, squared and integrated over time: holds the joint there."""

    type = "held_joint"
    joint: str
    angle_deg: Degrees
    weight: NonNegative  # of (q_joint - angle)^2, 1/(rad^2 s)

    def add(self, problem: Problem) -> list[Binding]:
        index = problem.coordinate(self.joint)
        angle = np.array([np.deg2rad(self.angle_deg)])
        return [
            problem.prog.AddQuadraticErrorCost(np.array([[share * self.weight]]), angle, problem.q(k)[[index]])
            for k, share in enumerate(problem.shares)
        ]


@checked_dataclass(kw_only=True)
class Duration(CostPiece):
    """The duration of the movement. Without it, a free duration becomes the longest one."""

    type = "duration"
    weight: NonNegative  # 1/s

    def add(self, problem: Problem) -> list[Binding]:
        cost = self.weight * (problem.times[-1] - problem.times[0])
        return [problem.prog.AddQuadraticCost([[0.0]], [0.0], cost, problem.q(0)[:1], is_convex=True)]
