"""drakearm's perturbations of the body, of its muscles and of its senses."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Annotated

import numpy as np
import scipy
from pydantic import Discriminator, Field, Tag, ValidationError, field_validator
from pydrake.common import RandomDistribution
from pydrake.systems.framework import DiagramBuilder, OutputPort
from pydrake.systems.primitives import Adder, LinearTransformDensity, Saturation, SparseMatrixGain, TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drakearm.diagrams.muscle_arm import TIME_STEP, MuscleArm
from drakearm.diagrams.perturbation import Perturbation
from drakearm.errors import TaskError, did_you_mean, shown
from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Finite, NonNegative, PlainText, Positive
from drakearm.model import Arm, Muscle
from drakearm.model.reference import CONTROL_STEP
from drakearm.systems.delay_line import DelayLine
from drakearm.systems.noise import Noise
from drakearm.task import TrackingTask

_LONGEST = 60.0  # s
_Seconds = Annotated[NonNegative, Field(le=_LONGEST)]
_Factor = Annotated[Positive, Field(ge=0.01, le=100.0)]
_FactorOfOne = Annotated[NonNegative, Field(le=100.0)]
_LEAST_FORCE = 1e-6  # N, the least maximum isometric force that a `Muscle` can have
_Torque = Annotated[Finite, Field(ge=-1e4, le=1e4)]  # Nm


@checked_dataclass()
class ExtraLoad(Perturbation):
    """A mass in the hand, beside the load that the controller knows."""

    type = "extra_load"
    mass: Annotated[NonNegative, Field(le=1000.0)]  # kg

    def perturb_task(self, task: TrackingTask) -> TrackingTask:
        return replace(task, load_mass=task.load_mass + self.mass)


@checked_dataclass()
class Strength(Perturbation):
    """Muscles with other maximum isometric forces. Their tendons become as much stiffer as the muscles get stronger.

    factor: of all maximum isometric forces, or those of some muscles by their names. A muscle with the factor 0 exerts
    nothing, not even a passive force: only a millionth of a newton remains.
    """

    type = "strength"
    factor: Annotated[
        Annotated[_Factor, Tag("number")] | Annotated[dict[PlainText, _FactorOfOne], Tag("mapping")],
        Discriminator(lambda value: "mapping" if isinstance(value, Mapping) else "number"),
    ]

    def perturb_task(self, task: TrackingTask) -> TrackingTask:
        """Raises TaskError for a muscle that the arm does not have, and if a force is more than an arm can have."""
        return replace(task, arm=replace(task.arm, muscles=tuple(self._scaled(task.arm))))

    def _scaled(self, arm: Arm) -> Iterator[Muscle]:
        names = arm.muscle_names
        factors = self.factor if isinstance(self.factor, dict) else dict.fromkeys(names, self.factor)
        for name in factors:
            if name not in names:
                raise TaskError(
                    f"The strength is that of the muscle {shown(name)}{did_you_mean(name, names)}: expected muscles of "
                    f"the arm {arm.name}, such as {', '.join(names[:5])}."
                )
        for muscle in arm.muscles:
            factor = factors.get(muscle.name, 1.0)
            force = factor * muscle.max_isometric_force if factor else _LEAST_FORCE
            try:
                yield replace(muscle, max_isometric_force=force)
            except ValidationError as error:
                raise TaskError(
                    f"The strength {factor:g} gives a muscle of the arm {arm.name} a maximum isometric force of "
                    f"{force:.3g} N: {error.errors()[0]['msg']}."
                ) from error


@checked_dataclass()
class MotorNoise(Perturbation):
    """Noise on excitations that grows with them: signal-dependent noise (Harris and Wolpert 1998).

    Each control step draws it anew for each muscle. Muscles clamp the result to 0..1.
    """

    type = "motor_noise"
    share: Annotated[NonNegative, Field(le=10.0)]  # standard deviation of the noise over the excitation

    def perturb_excitation(self, builder: DiagramBuilder, excitation: OutputPort) -> OutputPort:
        n = excitation.size()
        u = self.add_system(builder, Saturation(np.zeros(n), np.ones(n)))
        rows = np.arange(n) * (n + 1)  # of the diagonal of a matrix (n, n), whose columns stand one below the other
        diagonal = scipy.sparse.csc_matrix((np.full(n, self.share), (rows, np.arange(n))), shape=(n * n, n))
        deviation = self.add_system(builder, SparseMatrixGain(diagonal))
        w = self.add_system(builder, Noise(n, CONTROL_STEP))
        noisy = self.add_system(builder, LinearTransformDensity(RandomDistribution.kGaussian, n, n))  # u + deviation w
        builder.Connect(excitation, u.get_input_port())
        builder.Connect(u.get_output_port(), deviation.get_input_port())
        builder.Connect(deviation.get_output_port(), noisy.get_input_port_A())
        builder.Connect(w.get_output_port(), noisy.get_input_port_w_in())
        builder.Connect(u.get_output_port(), noisy.get_input_port_b())
        return noisy.get_output_port_w_out()


@checked_dataclass()
class SensorDelay(Perturbation):
    """What the controller senses of its body is late. Until the delay has passed, it senses the start."""

    type = "sensor_delay"
    delay: Annotated[NonNegative, Field(le=1.0)]  # s, whole time steps

    @field_validator("delay")
    @classmethod
    def _whole_steps(cls, delay: float) -> float:
        if _steps(delay, TIME_STEP) is None:
            raise ValueError(f"expected a whole number of time steps of {TIME_STEP} s")
        return delay

    def perturb_sense(self, builder: DiagramBuilder, name: str, signal: OutputPort) -> OutputPort:
        step = TIME_STEP if _steps(self.delay, CONTROL_STEP) is None else CONTROL_STEP
        steps = round(self.delay / step)
        if steps == 0:
            return signal
        line = self.add_system(builder, DelayLine(step, steps, signal.size()))
        builder.Connect(signal, line.get_input_port())
        return line.GetOutputPort("delayed_u")


@checked_dataclass()
class Push(Perturbation):
    """A torque on the joints for some time."""

    type = "push"
    torque: _Torque | tuple[_Torque, ...]  # Nm, one for all joints, or one for each
    start: _Seconds  # s, on the reference
    duration: _Seconds  # s

    def perturb_torque(self, builder: DiagramBuilder, torque: OutputPort, arm: MuscleArm) -> OutputPort:
        """Raises TaskError unless there is one torque, or one for each joint."""
        n_q = torque.size()
        if np.ndim(self.torque) == 1 and np.size(self.torque) != n_q:
            raise TaskError(f"The push has {np.size(self.torque)} torques: expected one, or {n_q}, one for each joint.")
        breaks = [self.start - 1.0, self.start, self.start + self.duration, self.start + self.duration + 1.0]
        pushed, none = np.broadcast_to(self.torque, n_q), np.zeros(n_q)
        trajectory = PiecewisePolynomial.ZeroOrderHold(breaks, np.transpose([none, pushed, none, none]))
        source = self.add_system(builder, TrajectorySource(trajectory))
        total = self.add_system(builder, Adder(2, n_q))
        builder.Connect(torque, total.get_input_port(0))
        builder.Connect(source.get_output_port(), total.get_input_port(1))
        return total.get_output_port()


def _steps(time: float, step: float) -> int | None:
    """How many steps a time (s) is; None if it is not a whole number of them."""
    steps = time / step
    return round(steps) if abs(steps - round(steps)) < 1e-6 else None
