"""DelayLine: what goes in comes out some steps later."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import LogVectorOutput, TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drakearm.systems import DelayLine

STEP, TIMES = 0.01, 0.01 * np.arange(12)


def run(longest, steps=None, empty=False):
    """The input (N, 2) at each step, and what the ports delayed_u and past_u show there."""
    values = np.random.default_rng(0).random((2, len(TIMES)))
    builder = DiagramBuilder()
    source = builder.AddSystem(TrajectorySource(PiecewisePolynomial.FirstOrderHold(TIMES, values)))
    line = builder.AddSystem(DelayLine(STEP, longest, 2, empty=empty))
    builder.Connect(source.get_output_port(), line.get_input_port())
    logs = [LogVectorOutput(line.GetOutputPort(name), builder, STEP) for name in ("delayed_u", "past_u")]
    simulator = Simulator(builder.Build())
    context = simulator.get_mutable_context()
    if steps is not None:
        line.SetSteps(context, steps)
    line.Begin(context)
    simulator.AdvanceTo(TIMES[-1])
    return values.T, *(log.FindLog(context).data().T for log in logs)


@pytest.mark.parametrize(("steps", "expected"), [(None, 3), (0, 0), (1, 1), (2, 2)])
def test_the_delay_is_the_number_of_steps(steps, expected):
    values, delayed, _ = run(3, steps)
    late = np.concatenate([np.repeat(values[:1], expected, axis=0), values[: len(values) - expected]])
    np.testing.assert_allclose(delayed, late, atol=1e-12)


def test_the_past_is_the_latest_first():
    values, _, past = run(3, empty=True)
    np.testing.assert_allclose(past[5], values[[4, 3, 2]].ravel(), atol=1e-12)
    np.testing.assert_allclose(past[1], [*values[0], 0.0, 0.0, 0.0, 0.0], atol=1e-12)
